//! `ieap answer`.

use clap::Args;
use serde_json::json;

use super::campaign::{CampaignArg, say_what_was_agreed};
use super::exit::{CliError, DONE};
use super::global::Global;
use super::output::Output;
use super::tag::user_name;
use crate::pipeline::{Answer, Context};

/// Say that you looked after words that may be lost since a rebuilding: `status` and `run` then end as ever
#[derive(Debug, Args)]
pub struct AnswerArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// What you found: it is kept in the journal
    #[arg(long, value_name = "TEXT")]
    why: String,
    /// Who says it [default: the user's name]
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
}

pub fn run(args: &AnswerArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = Context::open_beside(&args.campaign.folder()?, global.i_know)?;
    say_what_was_agreed(&context, output);
    let answer = Answer {
        why: args.why.clone(),
        by: args.by.clone().unwrap_or_else(user_name),
    };
    let answered = answer.run(&mut context)?;
    if answered.lost.is_empty() {
        output.result("no words are known that may be lost: nothing to answer");
    }
    for lost in &answered.lost {
        output.result(&format!("answered: {lost}"));
    }
    output.document(&json!({ "schema": "ieap/answer/1", "answer": answered }))?;
    Ok(DONE)
}
