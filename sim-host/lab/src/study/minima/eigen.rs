//! Eigenvalues of symmetric matrices.

/// Most sweeps; each one about squares what is left beside the diagonal.
const SWEEPS: usize = 30;

/// Eigenvalues in ascending order, by Jacobi's cyclic method. O(n^3) per sweep.
pub(super) fn eigenvalues(mut matrix: Vec<Vec<f64>>) -> Vec<f64> {
    let n = matrix.len();
    let total: f64 = matrix.iter().flatten().map(|entry| entry * entry).sum();
    for _ in 0..SWEEPS {
        let pairs = || (0..n).flat_map(move |row| (row + 1..n).map(move |column| (row, column)));
        let beside: f64 = pairs().map(|(row, column)| matrix[row][column] * matrix[row][column]).sum();
        if beside <= 1e-28 * total {
            break;
        }
        for (p, q) in pairs() {
            rotate(&mut matrix, p, q);
        }
    }
    let mut values: Vec<f64> = (0..n).map(|row| matrix[row][row]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Rotates axes `p` and `q` so that their common entry becomes 0.
fn rotate(matrix: &mut [Vec<f64>], p: usize, q: usize) {
    let entry = matrix[p][q];
    if entry == 0.0 {
        return;
    }
    let half = (matrix[q][q] - matrix[p][p]) / (2.0 * entry);
    let tan = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
    let cos = 1.0 / (tan * tan + 1.0).sqrt();
    let sin = tan * cos;
    for row in matrix.iter_mut() {
        (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
    }
    if let Ok([upper, lower]) = matrix.get_disjoint_mut([p, q]) {
        for (upper, lower) in upper.iter_mut().zip(lower) {
            (*upper, *lower) = (cos * *upper - sin * *lower, sin * *upper + cos * *lower);
        }
    }
}
