//! Conversion between the rows of files and images (first row in the north) and the rows of
//! [`super::Terrain`] (row 0 in the south). No other module converts rows.

/// Terrain row of a file row (less than `height`) on a map of `height` rows; its own inverse.
#[must_use]
pub const fn flip_row(row: u16, height: u16) -> u16 {
    height - 1 - row
}

/// Reverses the rows of a grid, `width` values each, from file order to terrain order or back.
pub fn flip_rows<T>(grid: &mut [T], width: u16) {
    let width = usize::from(width);
    let height = (grid.len() / width.max(1)) as u16;
    for row in 0..height / 2 {
        let (south, north) = grid.split_at_mut(usize::from(flip_row(row, height)) * width);
        let at = usize::from(row) * width;
        south[at..at + width].swap_with_slice(&mut north[..width]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_file_row_is_the_northernmost() {
        assert_eq!(flip_row(0, 1), 0);
        assert_eq!(flip_row(0, 5), 4);
        assert_eq!(flip_row(4, 5), 0);
        assert_eq!(flip_row(2, 5), 2);
        assert_eq!(flip_row(0, u16::MAX), u16::MAX - 1);
    }

    #[test]
    fn rows_are_reversed_and_restored() {
        for (height, expected) in
            [(1, vec![0, 1, 2]), (2, vec![3, 4, 5, 0, 1, 2]), (3, vec![6, 7, 8, 3, 4, 5, 0, 1, 2])]
        {
            let original: Vec<i32> = (0..3 * height).collect();
            let mut grid = original.clone();
            flip_rows(&mut grid, 3);
            assert_eq!(grid, expected);
            flip_rows(&mut grid, 3);
            assert_eq!(grid, original);
        }
        flip_rows::<u8>(&mut [], 0);
    }

    #[test]
    fn grids_and_rows_are_converted_alike() {
        let (width, height) = (4, 7);
        let mut grid: Vec<u16> = (0..width * height).map(|at| at / width).collect();
        flip_rows(&mut grid, width);
        for row in 0..height {
            assert_eq!(grid[usize::from(row * width)], flip_row(row, height));
        }
    }
}
