//! A wrong constant in a law turns a figure of its paper red: errors are planted in a copy of the
//! sources, one at a time, and a figure must show each.

use crate::prelude::*;

/// One error in each law of a paper, and the figure that must be red then.
#[rustfmt::skip]
const PLANTS: [(&str, Plant); 7] = [
    ("route", Plant { name: "route: the way behind the window at an eighth of its price (KUZ)",
        file: "controller/src/laws/route/field/beyond.rs",
        right: "params.a3.of(distance(cell) - base)",
        wrong: "params.a3.of((distance(cell) - base) >> 3)" }),
    ("formation", Plant { name: "formation: a leader that never waits (KUZ)",
        file: "controller/src/laws/formation/steering.rs",
        right: "self.waits = lag > u32::from(limit);",
        wrong: "self.waits = lag > u32::from(limit) << 8;" }),
    ("formation", Plant { name: "formation_paper: places without weight (KUZ)",
        file: "papers/src/formation.rs",
        right: "let price = sums(self.formation.gain, cell, &found.members);",
        wrong: "let price = sums(staya_controller::cost::Gain::ZERO, cell, &found.members);" }),
    ("hooking", Plant { name: "goal_flock: repulsion that ends at R_MinDist (PAV)",
        file: "controller/src/laws/goal_flock/mod.rs",
        right: "let lack = S::TWO - ratio.unwrap_or(S::TWO).clamp(S::HALF, S::TWO);",
        wrong: "let lack = S::ONE - ratio.unwrap_or(S::ONE).clamp(S::HALF, S::ONE);" }),
    ("flock", Plant { name: "alpha_flock: neighbours up to 1.6 spacings (OLF)",
        file: "controller/src/laws/lattice/mod.rs",
        right: "range_ratio: S::from_ratio(6, 5),",
        wrong: "range_ratio: S::from_ratio(8, 5)," }),
    ("fvm-example", Plant { name: "orca: the whole change instead of a robot's share (FVM)",
        file: "controller/src/orca/plane.rs",
        right: "let point = own_velocity_mps + normal * (u * params.share);",
        wrong: "let point = own_velocity_mps + normal * u;" }),
    ("patterns", Plant { name: "boids: headings that turn away from the mean (STA)",
        file: "controller/src/laws/boids/mod.rs",
        right: "let aligned = self.towards(heading, velocities);",
        wrong: "let aligned = self.towards(heading, -velocities);" }),
];

/// Builds each copy and runs the plant's figure with few seeds.
pub fn run(s: &mut Session) {
    for (figure, plant) in &PLANTS {
        s.report.step(&format!("a figure shows it: {}", plant.name), || is_shown(&s.repo, plant, figure));
    }
}

fn is_shown(repo: &Repo, plant: &Plant, name: &str) -> Result<()> {
    let (folder, target) = (repo.target.join("planted-laws"), repo.target.join("planted-laws-target"));
    repo.plant(&folder, plant)?;
    let mut build = repo.cargo("build --locked --release --package staya-lab --bin staya-lab");
    execute(build.current_dir(&folder).env("CARGO_TARGET_DIR", &target))?;
    let mut figure = repo.command(target.join("release/staya-lab"));
    figure.args(["experiment", name, "--quick", "--restart", "--out"]).arg(folder.join("out"));
    let output = figure.current_dir(&folder).output().context("cannot start staya-lab")?;
    let said = String::from_utf8_lossy(&output.stdout);
    let verdict = said.lines().find(|line| line.contains("DOES NOT HOLD"));
    if let (Some(verdict), Some(1)) = (verdict, output.status.code()) {
        println!("{verdict}");
        return Ok(());
    }
    print!("{said}{}", String::from_utf8_lossy(&output.stderr));
    bail!("`{}` in {} leaves the figure {name} as it is", plant.wrong, plant.file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_error_has_its_place_and_its_figure() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a folder");
        let figures = files::sources(&root.join("papers"), &["toml"]).expect("figures");
        let figures: Vec<String> = figures.iter().map(|file| files::read(file).expect("a file")).collect();
        for (figure, plant) in &PLANTS {
            plant.planted(&files::read(&root.join(plant.file)).expect("a file")).expect(plant.name);
            let name = format!("\nname = \"{figure}\"\n");
            assert!(figures.iter().any(|text| text.contains(&name)), "{figure}");
        }
    }
}
