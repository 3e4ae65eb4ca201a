//! Parameter sweeps: cases made of a scenario, computed by the tasks of the core, stored as they are finished, and gathered.
//!
//! Cases are numbered from 0, the last dimension fastest. What is kept of them is stored in files of several cases each, in a
//! folder named by the hash of all that determines it ([`Store`]), so that a sweep can be stopped at any moment, continued, and
//! computed in parts on several machines. The finished sweep is one labelled data set ([`Dataset`]).

mod batch;
mod case;
mod dataset;
mod drawn;
mod error;
mod files;
mod gathered;
mod keep;
mod netcdf;
mod plan;
mod read;
mod run;
mod schema;
mod store;
mod table;

pub use batch::Batch;
pub use case::{Case, Kept, Value};
pub use dataset::{Axis, Dataset, Labelled, Values, named};
pub use error::{Error, Result};
pub use files::{AxisReport, KeptReport, Report, write};
pub use gathered::Gathered;
pub use keep::{Keep, Summaries};
pub use netcdf::attributes;
pub use plan::Plan;
pub use read::read_drawn;
pub use run::{Part, compute, run};
pub use schema::Entry;
pub use store::{Identity, Store};
