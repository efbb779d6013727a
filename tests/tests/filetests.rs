//! Runs the golden files; `BLESS=1` rewrites them. See `golden.rs`.

use std::path::Path;

#[test]
fn golden_files() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("files");
    let bless = std::env::var_os("BLESS").is_some_and(|v| v == "1");
    match jerboa_tests::golden::run_folder(&folder, bless) {
        Ok(files) => assert!(files > 0, "no golden files"),
        Err(differences) => panic!("{differences}"),
    }
}
