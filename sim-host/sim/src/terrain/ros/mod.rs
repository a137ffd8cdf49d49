//! Maps of the Robot Operating System: a `map_server` YAML file with a PGM image.
//!
//! A pixel of brightness x out of the image's largest value M is occupied with probability p = 1 -
//! x/M (x/M if `negate` is set). p > `occupied_thresh` is blocked, p < `free_thresh` is free
//! (impassability 1). Values between the thresholds are unknown in mode `trinary`. In mode `scale`
//! they have impassability 1 + round((l - 1)(p - free)/(occupied - free)) with l classes. Images
//! list rows from the north; [`super::rows`] reverses them.
//!
//! Staya writes terrain in this format too ([`save`]): with mode `scale` and the number of classes
//! under the key `impassability_classes`, which ROS ignores. Every impassability is restored
//! exactly, the image shows the terrain (darker is slower), and ROS tools can open it.
//!
//! Source: ROS wiki, `map_server`, "Map format"; Netpbm, "PGM".

mod pgm;
mod yaml;

use super::error::{Place, TerrainError, format_error, parameter_error, read};
use super::rows::flip_rows;
use super::{LoadOptions, Terrain};
use crate::record::write_atomically;
use pgm::Picture;
use staya_controller::grid::BLOCKED;
use std::path::{Path, PathBuf};

pub use pgm::parse_pgm;
pub use yaml::{Meta, Mode, parse_meta};

/// Thresholds for 255 classes and walls: 255 grey levels from p = 0 to 254/255, and black.
const FREE_THRESH: f64 = 0.0;
const OCCUPIED_THRESH: f64 = 0.997;

fn impassability(p: f64, meta: &Meta, options: &LoadOptions) -> u8 {
    if p > meta.occupied_thresh {
        return BLOCKED;
    }
    if p < meta.free_thresh {
        return 1;
    }
    match meta.mode {
        Mode::Trinary => options.unknown,
        Mode::Scale => {
            let classes = meta.classes.unwrap_or(options.classes);
            let span = meta.occupied_thresh - meta.free_thresh;
            let share = if span > 0.0 { (p - meta.free_thresh) / span } else { 0.0 };
            1 + (f64::from(classes - 1) * share).round() as u8
        }
    }
}

/// Converts an image to terrain. O(size).
///
/// # Errors
/// A [`TerrainError::Size`] if the image is too large; a [`TerrainError::Parameter`] for 0 classes.
pub fn interpret(picture: &Picture, meta: &Meta, options: &LoadOptions) -> Result<Terrain, TerrainError> {
    if options.classes == 0 {
        return Err(parameter_error("classes is 0", "give the number of classes, 1..=255"));
    }
    let probability = |pixel: &u16| {
        let x = f64::from(if meta.negate { *pixel } else { picture.largest - *pixel });
        x / f64::from(picture.largest)
    };
    let is_unknown = |p: f64| meta.mode == Mode::Trinary && (meta.free_thresh..=meta.occupied_thresh).contains(&p);
    let mut probabilities: Vec<f64> = picture.pixels.iter().map(probability).collect();
    flip_rows(&mut probabilities, picture.width);
    let cells = probabilities.iter().map(|p| impassability(*p, meta, options)).collect();
    let mut terrain = Terrain::from_cells(picture.width, picture.height, cells)?;
    terrain.mark_unknown(probabilities.into_iter().map(is_unknown));
    terrain.cell_m = meta.resolution_m;
    terrain.origin_m = meta.origin_m;
    Ok(terrain)
}

/// Path of the image that a YAML file names.
pub fn picture(path: &Path) -> Result<PathBuf, TerrainError> {
    let meta = parse_meta(&read(path)?, path)?;
    Ok(path.parent().unwrap_or(Path::new("")).join(meta.image))
}

/// Reads a YAML file and the image that it names (relative to the YAML file).
///
/// # Errors
/// A [`TerrainError::Read`] or [`TerrainError::Format`] for either file.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Terrain, TerrainError> {
    let meta = parse_meta(&read(path)?, path)?;
    let image = path.parent().unwrap_or(Path::new("")).join(&meta.image);
    let is_pgm = image.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pgm"));
    if !is_pgm {
        return Err(format_error(
            path,
            Place::File,
            format!("image is {:?}", meta.image),
            "only PGM pictures are read: convert it, for example with ImageMagick, and name the .pgm",
        ));
    }
    interpret(&parse_pgm(&read(&image)?, &image)?, &meta, options)
}

/// Writes `path` (.yaml) and its image (.pgm); [`Terrain::load`] of `path` gives an equal terrain.
///
/// # Errors
/// A [`TerrainError::Write`]; a [`TerrainError::Format`] if YAML cannot hold the file name.
pub fn save(terrain: &Terrain, path: &Path) -> Result<(), TerrainError> {
    let image: PathBuf = path.with_extension("pgm");
    let name = image.file_name().and_then(|name| name.to_str()).filter(|name| !name.contains(['"', '\\', '\n', '\r']));
    let Some(name) = name else {
        return Err(format_error(
            path,
            Place::File,
            "the file name has a quote, a backslash, a line break or no UTF-8",
            "choose a plainer name",
        ));
    };
    let classes = terrain.cells().iter().copied().max().unwrap_or(1).max(1);
    let [x, y] = terrain.origin_m;
    let meta = format!(
        "image: \"{name}\"\nmode: scale\nresolution: {:?}\norigin: [{x:?}, {y:?}, 0.0]\nnegate: 0\n\
         occupied_thresh: {OCCUPIED_THRESH:?}\nfree_thresh: {FREE_THRESH:?}\nimpassability_classes: {classes}\n",
        terrain.cell_m
    );
    let mut pixels: Vec<u8> = terrain.cells().iter().map(|u| brightness(*u, classes)).collect();
    flip_rows(&mut pixels, terrain.width());
    let mut picture = format!("P5\n{} {}\n255\n", terrain.width(), terrain.height()).into_bytes();
    picture.extend_from_slice(&pixels);
    write_atomically(&image, &picture)?;
    Ok(write_atomically(path, meta.as_bytes())?)
}

/// Inverse of [`impassability`]: rounding to a grey level shifts the class by less than one half.
fn brightness(impassability: u8, classes: u8) -> u8 {
    if impassability == BLOCKED {
        return 0;
    }
    let steps = f64::from(classes.max(2) - 1);
    let share = f64::from(impassability - 1) / steps;
    let darkness = (share * OCCUPIED_THRESH * 255.0).round();
    255 - darkness as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::grid::Cell;

    const META: &str =
        "image: a.pgm\nresolution: 0.05\norigin: [-1.5, 2, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0\n";

    fn read(meta: &str, picture: &str, options: &LoadOptions) -> Terrain {
        let meta = parse_meta(meta.as_bytes(), Path::new("a.yaml")).unwrap();
        let picture = parse_pgm(picture.as_bytes(), Path::new("a.pgm")).unwrap();
        interpret(&picture, &meta, options).unwrap()
    }

    const PICTURE: &str = "P2\n3 2\n255\n254 205 0\n0 255 254\n";

    #[test]
    fn trinary_maps_become_free_and_blocked_cells() {
        let terrain = read(META, PICTURE, &LoadOptions::default());
        assert_eq!(terrain.cells(), [BLOCKED, 1, 1, 1, BLOCKED, BLOCKED]);
        assert_eq!((terrain.cell_m, terrain.origin_m), (0.05, [-1.5, 2.0]));
        let brave = LoadOptions { unknown: 7, ..LoadOptions::default() };
        assert_eq!(read(META, PICTURE, &brave).get(Cell::new(1, 1)), 7);
        let unknown = |terrain: &Terrain| [0, 1].map(|y| [0, 1, 2].map(|x| terrain.is_unknown(Cell::new(x, y))));
        assert_eq!(unknown(&terrain), [[false; 3], [false, true, false]]);
        assert_eq!(unknown(&read(META, PICTURE, &brave)), [[false; 3]; 2]);
    }

    #[test]
    fn negated_maps_are_inverted() {
        let meta = META.replace("negate: 0", "negate: 1");
        let terrain = read(&meta, PICTURE, &LoadOptions::default());
        assert_eq!(terrain.cells(), [1, BLOCKED, BLOCKED, BLOCKED, BLOCKED, 1]);
    }

    #[test]
    fn scale_maps_are_linear_between_the_thresholds() {
        let meta = format!("{META}mode: scale\n").replace("0.65", "0.8").replace("0.196", "0.2");
        let terrain = read(&meta, "P2 5 1 10 10 8 5 2 0", &LoadOptions::default());
        assert_eq!(terrain.cells(), [1, 1, 5, 9, BLOCKED]);
    }

    #[test]
    fn sixteen_bit_pictures_have_the_same_meaning() {
        let meta = parse_meta(META.as_bytes(), Path::new("a.yaml")).unwrap();
        let picture = parse_pgm(b"P5 2 1 65535\n\xFF\xFF\x00\x10", Path::new("a.pgm")).unwrap();
        let terrain = interpret(&picture, &meta, &LoadOptions::default()).unwrap();
        assert_eq!(terrain.cells(), [1, BLOCKED]);
    }

    #[test]
    fn every_class_is_restored_for_any_number_of_classes() {
        let meta = Meta {
            mode: Mode::Scale,
            free_thresh: FREE_THRESH,
            occupied_thresh: OCCUPIED_THRESH,
            ..parse_meta(META.as_bytes(), Path::new("a.yaml")).unwrap()
        };
        for classes in 1..=255 {
            let meta = Meta { classes: Some(classes), ..meta.clone() };
            for u in 0..=classes {
                let p = f64::from(255 - brightness(u, classes)) / 255.0;
                assert_eq!(impassability(p, &meta, &LoadOptions::default()), u, "of {classes}");
            }
        }
    }

    #[test]
    fn a_saved_terrain_loads_equal() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("land.yaml");
        let mut terrain = Terrain::from_cells(3, 2, vec![1, 9, BLOCKED, 4, 2, 3]).unwrap();
        terrain.cell_m = 1.0 / 3.0;
        terrain.origin_m = [-1e9, 0.1];
        save(&terrain, &path).unwrap();
        assert_eq!(Terrain::load(&path).unwrap(), terrain);
    }

    #[test]
    fn unsupported_images_and_missing_files_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.yaml");
        let message = |path: &Path| Terrain::load(path).unwrap_err().to_string();
        assert!(message(&path).contains("a.yaml: "));
        std::fs::write(&path, META).unwrap();
        assert!(message(&path).contains("a.pgm: "));
        std::fs::write(&path, META.replace("pgm", "png")).unwrap();
        assert!(message(&path).contains("image is \"a.png\"; only PGM pictures are read"));
        let odd = dir.path().join("a\"b.yaml");
        assert!(save(&Terrain::flat(1, 1), &odd).is_err());
    }
}
