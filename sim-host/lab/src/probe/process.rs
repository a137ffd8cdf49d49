//! Resource usage of this process (Linux: `/proc`, see proc(5)).

use std::fs;

const CLOCK_HZ: f64 = 100.0;

/// Processor time of all threads; `None` if the system does not report it.
#[derive(Clone, Copy, Debug)]
pub struct Usage(Option<f64>);

impl Usage {
    pub fn now() -> Self {
        let text = fs::read_to_string("/proc/self/stat").unwrap_or_default();
        Self(processor_s(&text))
    }

    pub fn since(self, before: Self) -> Option<f64> {
        Some(self.0? - before.0?)
    }
}

/// Fields 14 and 15. The name in field 2 may contain anything and ends with the last bracket.
fn processor_s(stat: &str) -> Option<f64> {
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11).map_while(|field| field.parse::<u64>().ok());
    let (user, system) = (times.next()?, times.next()?);
    Some((user + system) as f64 / CLOCK_HZ)
}

pub fn memory_bytes() -> Option<u64> {
    resident_bytes(&fs::read_to_string("/proc/self/status").ok()?)
}

fn resident_bytes(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn proc_files_of_linux_are_parsed() {
        let stat = "7 (a ) b) R 1 7 7 0 -1 4194304 10 0 0 0 250 50 0 0 20 0 3 0 99 1 2\n";
        assert_eq!(processor_s(stat), Some(3.0));
        assert_eq!(resident_bytes("Name:\tx\nVmRSS:\t    2048 kB\n"), Some(2048 * 1024));
        assert_eq!((processor_s("7 (a"), resident_bytes("VmHWM: 1 kB")), (None, None));
    }
}
