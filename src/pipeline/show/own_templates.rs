//! Templates of the report that a campaign has of its own: `[report] templates` names their folder.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use crate::pipeline::Context;
use crate::report::refused_template;
use crate::system::fs;

/// What stands in the folder.
#[derive(Debug, Default)]
pub struct OwnTemplates {
    /// Those that take the place of the program's, by their names.
    pub texts: BTreeMap<String, String>,
    /// Those that do not, each with the reason.
    pub left_out: Vec<String>,
}

impl OwnTemplates {
    /// Those of a campaign.
    pub fn of(context: &Context) -> OwnTemplates {
        let mut found = OwnTemplates::default();
        if let Some(folder) = &context.campaign.templates_folder {
            for below in ["", "blocks/"] {
                let path = format!("{folder}/{below}");
                let names = names(&context.folder.join(&path));
                match names {
                    Ok(names) => {
                        (names.iter()).for_each(|name| found.take(context, folder, &format!("{below}{name}")))
                    }
                    // Not every block has to be another.
                    Err(error) if !below.is_empty() && error.kind() == io::ErrorKind::NotFound => {}
                    Err(error) => found.left_out.push(format!("{path}: {error}")),
                }
            }
        }
        found
    }

    fn take(&mut self, context: &Context, folder: &str, name: &str) {
        let text = fs::read_stated_text(&context.folder, context.folder.join(folder).join(name));
        let text = text.map_err(|error| error.to_string());
        let taken = text.and_then(|text| match refused_template(name, &text) {
            None => Ok(text),
            Some(reason) => Err(reason),
        });
        match taken {
            Ok(text) => drop(self.texts.insert(name.to_owned(), text)),
            Err(reason) => self.left_out.push(format!("{folder}/{name}: {reason}")),
        }
    }

    /// What a report says of them that it was made from; nothing where there are none.
    pub fn mark(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for part in self.texts.iter().flat_map(|(name, text)| [name, text]) {
            hasher.update(blake3::hash(part.as_bytes()).as_bytes());
        }
        match self.texts.len() {
            0 => String::new(),
            _ => format!(" {}", hasher.finalize().to_hex()),
        }
    }
}

/// Names of the files in a folder that end as templates do, in order.
fn names(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        names.extend(Some(name).filter(|name| name.ends_with(".html")));
    }
    names.sort();
    Ok(names)
}
