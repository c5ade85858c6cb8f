//! Where and by what a result was made: for the foot of reports.

use std::path::Path;
use std::process::Command;
use std::thread::available_parallelism;

use serde::{Deserialize, Serialize};

/// A machine and a program. What is not known is left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor.
    pub processor: Option<String>,
    /// Processors that the program may use.
    pub processors: Option<usize>,
    /// Operating system and architecture.
    pub system: String,
    /// The version of vofkit.
    pub version: String,
    /// The compiler that made it.
    pub compiler: Option<String>,
    /// The revision of the sources.
    pub revision: Option<String>,
}

impl Machine {
    /// This machine and program. The revision is `VOFKIT_REVISION` at the time of the build; without it, that of the repository
    /// that `near` lies in, if it is one of vofkit.
    pub fn here(near: &Path) -> Self {
        let known = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        Self {
            processor: processor(),
            processors: available_parallelism().ok().map(usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            compiler: known(env!("VOFKIT_COMPILER")),
            revision: option_env!("VOFKIT_REVISION").map(str::to_owned).or_else(|| revision(near)),
        }
    }

    /// Names and values.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let processors = self.processors.map(|count| count.to_string());
        let known = [
            ("processor", self.processor.clone()),
            ("processors", processors),
            ("system", Some(self.system.clone())),
            ("vofkit", Some(self.version.clone())),
            ("compiler", self.compiler.clone()),
            ("revision", self.revision.clone()),
        ];
        known.into_iter().filter_map(|(name, value)| Some(vec![name.to_owned(), value?])).collect()
    }
}

/// The name of the processor, where the system tells it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim().to_owned())
}

/// The revision of the repository that a path lies in, marked where files differ from it.
fn revision(near: &Path) -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(near).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let manifest =
        std::fs::read_to_string(Path::new(&git(&["rev-parse", "--show-toplevel"])?).join("Cargo.toml"));
    let is_own = manifest.is_ok_and(|text| text.contains("name = \"vofkit\""));
    if is_own { git(&["describe", "--always", "--dirty"]) } else { None }
}
