//! Calling kernels.

use jerboa_backend_cranelift::{Binding, Status};

use super::error::Error;
use super::generate::Generated;
use super::tables::Tables;

/// The bindings of all tables; streams and [`crate::schema::Frame`] are the caller's to bind.
pub fn tables_bound(tables: &Tables) -> Vec<Binding> {
    let table = |words: &[u32], rows: u32| Binding { words: words.as_ptr().cast_mut(), rows };
    tables.memory.iter().map(|m| table(&m.words, m.rows)).collect()
}

/// Run a kernel. The caller has bound the tables that it was specialised for, and streams that it owns.
///
/// # Errors
/// When it gives up: a fault of Jerboa.
pub fn call(kernel: &Generated, bindings: &[Binding], args: &[u32]) -> Result<(), Error> {
    // SAFETY: each binding holds as many rows as it says, of the columns that the schema declares (`Tables::new`, tested);
    // only streams are written, and they are the caller's own. Unchecked indices come from the tree, whose children and
    // slots are in range by construction (`Bvh::build`). Threads of rayon and the main thread have the stack it asks for.
    match unsafe { kernel.kernel().call(bindings, args, &mut []) } {
        Status::Done => Ok(()),
        Status::Limit => {
            Err(Error::new("the kernel recursed beyond its limit: a fault of Jerboa, please report the scene"))
        }
    }
}
