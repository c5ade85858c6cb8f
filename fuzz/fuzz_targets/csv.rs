//! Any bytes as a table for `vofkit kernel`: an error that says what is wrong, and no table, or a table.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use vofkit::geometry::{PositionMethod, TruncationMethod};
use vofkit::kernel::{self, Job, Task};
use vofkit_fuzz::Folder;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::default);

fuzz_target!(|bytes: &[u8]| {
    let [input, output] = ["in.csv", "out.csv"].map(|name| FOLDER.join(name));
    fs::write(&input, bytes).expect("a table to read");
    for task in [Task::Truncate(TruncationMethod::Exact), Task::Position(PositionMethod::Auto)] {
        let job = Job { input: input.clone(), output: output.clone(), force: true, task, timed: false };
        let _ = fs::remove_file(&output);
        match kernel::run(&job) {
            Ok(_) => assert!(fs::read_to_string(&output).is_ok_and(|table| table.contains("cell_volume"))),
            Err(error) => assert!(!error.to_string().is_empty() && !output.exists()),
        }
    }
});
