//! `ieap figure`.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use super::table::write;
use crate::pipeline::show::figures::{MakeFigure, formats, listed, needs_no_campaign};

/// Draw a figure for print: SVG, PNG or PDF
///
/// At the width that it will have in print.
///
/// Without a name it lists the figures. Simulated ones (figures 13, 16, 18) need no campaign.
#[derive(Debug, Args)]
pub struct FigureArgs {
    /// Which figure; none: list them
    name: Option<String>,
    #[command(flatten)]
    campaign: CampaignArg,
    /// List the figures
    #[arg(long, hide = true)]
    list: bool,
    /// svg, png or pdf [default: by the ending of --output, else svg]
    #[arg(long, short, value_name = "FORMAT")]
    format: Option<String>,
    /// Width in print, mm [default: as the list says]
    #[arg(long, value_name = "MM")]
    width_mm: Option<f64>,
    /// Resolution of a PNG, dots per inch
    #[arg(long, value_name = "DPI", default_value_t = 600.0)]
    dpi: f64,
    /// Show this run only, of a figure of strips or of models: its path in the campaign
    #[arg(long, value_name = "RUN")]
    run: Option<String>,
    /// Show this parameter only, of the figures laws and monitoring: lambda, alpha, rss_ohm_cm2
    #[arg(long, value_name = "NAME")]
    parameter: Option<String>,
    /// File to write [default: NAME.FORMAT; - is stdout]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write over a file that is there
    #[arg(long)]
    overwrite: bool,
}

pub fn run(args: &FigureArgs, output: &Output) -> Result<u8, CliError> {
    let is_known = |name: &str| listed().any(|(known, alias, ..)| name == known || name == alias);
    let (name, folder) = args.campaign.with_name(args.name.as_deref(), is_known);
    let Some(name) = name.as_deref().filter(|_| !args.list) else {
        return list(output);
    };
    let format = format_of(args);
    let figure = MakeFigure {
        name: name.to_owned(),
        format: format.clone(),
        width_mm: args.width_mm,
        dots_per_inch: args.dpi,
        run: args.run.clone(),
        parameter: args.parameter.clone(),
    };
    let bytes = if needs_no_campaign(name) {
        figure.simulated()?
    } else {
        figure.run(&super::campaign::open_to_show(
            &super::campaign::folder(folder.as_deref())?,
            output,
        )?)?
    };
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{name}.{format}")));
    if path == Path::new("-") {
        if output.is_terminal() && format != "svg" {
            return Err(CliError::usage("stdout is a terminal: name a file with --output"));
        }
        output.write(&bytes);
        return Ok(DONE);
    }
    write(&path, &bytes, args.overwrite, output)?;
    output.document(
        &json!({ "schema": "ieap/figure/1", "file": path.display().to_string(), "bytes": bytes.len() }),
    )?;
    Ok(DONE)
}

/// `--format`, else the ending of the file, else SVG.
fn format_of(args: &FigureArgs) -> String {
    let ending = args.output.as_deref().and_then(Path::extension);
    let ending = ending.map(|ending| ending.to_string_lossy().into_owned());
    args.format.clone().or(ending).unwrap_or_else(|| "svg".to_owned())
}

pub(super) fn list(output: &Output) -> Result<u8, CliError> {
    for (name, alias, width_mm, about) in listed() {
        output.result(&format!("{name:<26} {alias:<22} {width_mm:>4} mm  {about}"));
    }
    let figures = listed().map(|(name, alias, width_mm, about)| {
        json!({ "name": name, "alias": alias, "width_mm": width_mm, "about": about })
    });
    output.document(
        &json!({ "schema": "ieap/figures/1", "formats": formats(), "figures": figures.collect::<Vec<_>>() }),
    )?;
    Ok(DONE)
}
