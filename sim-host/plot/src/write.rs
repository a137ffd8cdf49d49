//! Pictures as files.

use super::canvas::Canvas;
use super::{raster, svg};
use staya_sim::record::{self, Error};
use std::path::{Path, PathBuf};

impl Canvas {
    /// Writes `<stem>.svg` and `<stem>.png` (two pixels per unit), each completely or not at all,
    /// and creates the directory if needed. Equal pictures give equal bytes. Returns both paths.
    ///
    /// # Errors
    /// The directory or a file cannot be written.
    pub fn write(&self, stem: &Path) -> Result<Vec<PathBuf>, Error> {
        // Not `with_extension`: a stem may contain a point, as in `loss-0.3`.
        let with = |extension: &str| {
            let mut name = stem.as_os_str().to_owned();
            name.push(extension);
            PathBuf::from(name)
        };
        let (svg_path, png_path) = (with(".svg"), with(".png"));
        if let Some(dir) = stem.parent().filter(|dir| !dir.as_os_str().is_empty()) {
            record::make_dir(dir)?;
        }
        let png = raster::png(self).map_err(Error::new("draw", &png_path))?;
        let svg = svg::text(self).map_err(Error::new("draw", &svg_path))?;
        record::write_atomically(&svg_path, svg.as_bytes())?;
        record::write_atomically(&png_path, &png)?;
        Ok(vec![svg_path, png_path])
    }
}
