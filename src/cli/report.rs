//! `brakewave report`.

use std::path::PathBuf;

use clap::Args;

use super::failure::{VerbExit, VerbFailure};
use super::options::there;
use super::print;
use crate::output::report;
use crate::output::store::Store;

#[derive(Debug, Args)]
pub(crate) struct ReportArguments {
    /// Result folder of an earlier run, map, curve or simulation
    folder: PathBuf,
}

pub(crate) fn report(arguments: &ReportArguments) -> Result<VerbExit, VerbFailure> {
    there(&arguments.folder)?;
    let store = Store::visit(&arguments.folder)?;
    let page = report::page(&store)?;
    store.replace(report::PAGE, page.as_bytes())?;
    print(&format!("{}\n", store.path().join(report::PAGE).display()))?;
    Ok(VerbExit::Done)
}
