//! What Arrow's own schema says of columns that Parquet has no word for: durations, which stand as plain whole numbers.
//!
//! Every writer of the Arrow family keeps it under `ARROW:schema`: a message of Arrow's IPC format in base64 (Arrow,
//! format/Message.fbs and Schema.fbs).

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use parquet::file::metadata::FileMetaData;
use polars_arrow_format::ipc::planus::{Error, ReadAsRoot};
use polars_arrow_format::ipc::{FieldRef, MessageHeaderRef, MessageRef, TimeUnit, TypeRef};

const KEY: &str = "ARROW:schema";

/// Names of the columns that are durations, each with its digits behind the second: 0, 3, 6 or 9. None where a schema is
/// stated that cannot be read, so that nothing is known of its durations.
pub(super) fn durations(file: &FileMetaData) -> Option<Vec<(String, i32)>> {
    let mut pairs = file.key_value_metadata().into_iter().flatten();
    match pairs
        .find(|pair| pair.key == KEY)
        .map(|pair| pair.value.as_deref())
    {
        None => Some(Vec::new()),
        Some(text) => fields(&STANDARD.decode(text?).ok()?).ok().flatten(),
    }
}

/// The durations among the fields of a message; none where it is of another kind than a schema.
fn fields(message: &[u8]) -> Result<Option<Vec<(String, i32)>>, Error> {
    // The size stands before the message, since 2019 behind a mark.
    let start = if message.starts_with(&[0xff; 4]) { 8 } else { 4 };
    let message = MessageRef::read_as_root(message.get(start..).unwrap_or_default())?;
    let Some(MessageHeaderRef::Schema(schema)) = message.header()? else {
        return Ok(None);
    };
    let mut found = Vec::new();
    for field in schema.fields()?.into_iter().flatten() {
        found.extend(duration(field?)?);
    }
    Ok(Some(found))
}

fn duration(field: FieldRef) -> Result<Option<(String, i32)>, Error> {
    let (Some(TypeRef::Duration(kind)), Some(name)) = (field.type_()?, field.name()?) else {
        return Ok(None);
    };
    let digits = match kind.unit()? {
        TimeUnit::Second => 0,
        TimeUnit::Millisecond => 3,
        TimeUnit::Microsecond => 6,
        TimeUnit::Nanosecond => 9,
    };
    Ok(Some((name.to_owned(), digits)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_schema_is_told_and_ends_nothing() {
        for bytes in [
            &[][..],
            &[0xff; 3],
            &[0xff; 64],
            &[0; 64],
            b"\x10\0\0\0\x0c\0\0\0",
        ] {
            assert!(!matches!(fields(bytes), Ok(Some(_))), "{bytes:?}");
        }
    }
}
