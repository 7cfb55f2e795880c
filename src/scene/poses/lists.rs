//! Lists of poses as text, each from the camera (or the body that carries it) to the world.

use super::{Pose, of_rows};
use glam::{DQuat, DVec3};

type Result<T> = std::result::Result<T, String>;

/// A line's number and its numbers.
type Row = (usize, Vec<f64>);

/// Poses of a text, in its order:
///
/// * 8 numbers a line: TUM's `time x y z qx qy qz qw`; where a comment names q_w before q_x, `time x y z qw qx qy qz`
/// * 17 numbers with commas: EuRoC's ground truth, `time x y z qw qx qy qz` and more
/// * 12 numbers: the rows of KITTI's 3 x 4 matrices; 16: those of Replica's 4 x 4 matrices
/// * 13 or 17: KITTI-360's frame, and such a matrix
/// * four lines of 4 numbers: ScanNet's matrix; after a line of 3, each of Redwood's
pub fn poses(text: &str) -> Result<Vec<Pose>> {
    let lines = || text.lines().enumerate().map(|(n, line)| (n + 1, line.trim()));
    let is_data = |(_, line): &(usize, &str)| !line.is_empty() && !line.starts_with('#');
    let rows = lines().filter(is_data).map(row).collect::<Result<Vec<Row>>>()?;
    let has_commas = lines().find(is_data).is_some_and(|(_, line)| line.contains(','));
    let header = lines().find(|(_, line)| line.starts_with('#')).map_or("", |(_, line)| line);
    let place = |w: [&str; 2]| w.into_iter().find_map(|name| header.find(name));
    let w_first = match (place(["q_w", "q_RS_w"]), place(["q_x", "q_RS_x"])) {
        (Some(w), Some(x)) => w < x,
        _ => false,
    };
    match (rows.first().map(|row| row.1.len()), rows.get(1).map(|row| row.1.len())) {
        (Some(4), _) => return blocks(&rows, 0),
        (Some(3), Some(4)) => return blocks(&rows, 1),
        _ => {}
    }
    let pose = |(n, numbers): &Row| match numbers[..] {
        [_time, x, y, z, qw, qx, qy, qz] if w_first => Ok((DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw))),
        [_time, x, y, z, qx, qy, qz, qw] => Ok((DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw))),
        [_time, x, y, z, qw, qx, qy, qz, ..] if numbers.len() == 17 && has_commas => {
            Ok((DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw)))
        }
        _ if matches!(numbers.len(), 12 | 16) => of_matrix(*n, numbers),
        [_frame, ref matrix @ ..] if matches!(matrix.len(), 12 | 16) => of_matrix(*n, matrix),
        _ => Err(format!(
            "line {n}: {} numbers; TUM's poses have 8 (time, x, y, z, qx, qy, qz, qw), KITTI's 12, KITTI-360's 13 or 17, Replica's 16, EuRoC's 17 with commas",
            numbers.len()
        )),
    };
    rows.iter().map(pose).collect()
}

fn row((n, line): (usize, &str)) -> Result<Row> {
    let words = line.split(|c: char| c.is_ascii_whitespace() || c == ',').filter(|word| !word.is_empty());
    let read = |word: &str| word.parse().map_err(|_| format!("line {n}: {word:?} is not a number"));
    Ok((n, words.map(read).collect::<Result<_>>()?))
}

/// Matrices of four lines, each after so many other lines.
fn blocks(rows: &[Row], before: usize) -> Result<Vec<Pose>> {
    let block = |block: &[Row]| {
        let n = block[0].0;
        let four = block.get(before..).unwrap_or_default();
        let matrix: Vec<f64> = four.iter().flat_map(|row| &row.1).copied().collect();
        if block.len() != before + 4 || four.iter().any(|row| row.1.len() != 4) {
            return Err(format!("line {n}: the matrix from here on must be four lines of 4 numbers"));
        }
        of_matrix(n, &matrix)
    };
    rows.chunks(before + 4).map(block).collect()
}

/// The rows of a 3 x 4 or 4 x 4 matrix.
fn of_matrix(n: usize, numbers: &[f64]) -> Result<Pose> {
    let row = |k: usize| [0, 1, 2, 3].map(|c| numbers[4 * k + c]);
    if numbers.get(12..).is_some_and(|last| !last.is_empty() && *last != [0.0, 0.0, 0.0, 1.0]) {
        return Err(format!("line {n}: the last row of the matrix must be 0 0 0 1"));
    }
    of_rows(&[row(0), row(1), row(2)]).map_err(|why| format!("line {n}: {why}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera at (0.5, 0.25, 2) that is rotated by 90 degrees about z.
    const MATRIX: [&str; 4] = ["0 -1 0 0.5", "1 0 0 0.25", "0 0 1 2", "0 0 0 1"];

    #[test]
    fn lists_of_data_sets_are_told_apart() {
        let [a, b, c, d] = MATRIX;
        let h = 0.5f64.sqrt();
        let rest = ",0".repeat(9);
        let quaternion = format!("{h:?},0,0,{h:?}");
        for (name, text) in [
            ("KITTI", format!("{a} {b} {c}\n")),
            ("KITTI-360", format!("7 {a} {b} {c}\n")),
            ("KITTI-360's cameras", format!("7 {a} {b} {c} {d}\n")),
            ("Replica", format!("{a} {b} {c} {d}\n")),
            ("ScanNet", format!("{a}\n{b}\n{c}\n{d}\n")),
            ("Redwood", format!("0 0 1\n{a}\n{b}\n{c}\n{d}\n")),
            ("TUM", format!("# time tx ty tz qx qy qz qw\n1.5 0.5 0.25 2 0 0 {h:?} {h:?}\n")),
            ("EuRoC", format!("#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z\n14036,0.5,0.25,2,{quaternion}{rest}\n")),
            (
                "EuRoC's mocap",
                format!("#timestamp [ns], p_RS_R_x [m], q_RS_w [], q_RS_x []\n14036,0.5,0.25,2,{quaternion}\n"),
            ),
        ] {
            let found = poses(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
            let [(eye, rotation)] = found[..] else { panic!("{name}: {found:?}") };
            assert_eq!(eye, DVec3::new(0.5, 0.25, 2.0), "{name}");
            // some roundings of a quaternion's components
            assert!((rotation * DVec3::X - DVec3::Y).length() < 4.0 * f64::EPSILON, "{name}: {rotation}");
        }
        let two = [MATRIX.join("\n"), MATRIX.join("\n")].join("\n1 1 2\n");
        assert_eq!(poses(&format!("0 0 1\n{two}\n")).unwrap().len(), 2);
    }

    /// First lines of public lists: the eye is as written, and the camera looks along the third column of the rotation.
    #[test]
    fn heads_of_public_lists_are_read() {
        let column = |q: [f64; 4]| {
            let [x, y, z, w] = q;
            DVec3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w + z * z - x * x - y * y)
        };
        for (origin, text, eye, forward) in [
            (
                "MichaelGrupp/evo: test/data/fr2_desk_groundtruth.txt (TUM)",
                "# ground truth trajectory\n# file: 'rgbd_dataset_freiburg2_desk.bag'\n# timestamp tx ty tz qx qy qz qw\n\
                 1311868163.8697 -0.1357 -1.4217 1.4764 0.6453 -0.5498 0.3363 -0.4101\n",
                [-0.1357, -1.4217, 1.4764],
                column([0.6453, -0.5498, 0.3363, -0.4101]),
            ),
            (
                "MichaelGrupp/evo: test/data/V102_groundtruth.csv (EuRoC)",
                "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1]\n\
                 1403715524907143168,0.515356,1.996773,0.971104,0.161996,0.789985,-0.205376,0.554528,-0.002276,-0.009616,-0.005214,\
                 -0.002153,0.020744,0.075806,-0.013337,0.103464,0.093086\n",
                [0.515356, 1.996773, 0.971104],
                column([0.789985, -0.205376, 0.554528, 0.161996]),
            ),
            (
                "MichaelGrupp/evo: test/data/KITTI_00_gt.txt",
                "9.999796e-01 1.566466e-03 -6.198571e-03 -1.406429e-01 -1.587952e-03 9.999927e-01 -3.462706e-03 -8.515762e-02 \
                 6.193102e-03 3.472479e-03 9.999747e-01 2.574964e+00\n",
                [-0.1406429, -0.08515762, 2.574964],
                DVec3::new(-6.198571e-03, -3.462706e-03, 0.9999747),
            ),
            (
                "changh95/3d_pose_viewer: cam0_to_world.txt (KITTI-360)",
                "1 0.997378 -2.658562e-02 0.067320 -1.666421e+03 -0.069423 -8.827610e-02 0.993674 -1.973146e+03 -0.020474 \
                 -9.957414e-01 -0.089889 1.182260e+02 0.000000 0 0.000000 1 \n",
                [-1666.421, -1973.146, 118.226],
                DVec3::new(0.067320, 0.993674, -0.089889),
            ),
            (
                "langsungn/MonoGS: traj.txt (as Replica)",
                "9.062491181555123454e-01 -2.954311239679592860e-01 3.023788796086531172e-01 -3.569159214564542326e-01 \
                 -4.227440547687880690e-01 -6.333245673155291078e-01 6.482186796076164770e-01 -6.602722315763628336e-01 \
                 8.759610522377010340e-17 -7.152764804085384176e-01 -6.988415818870352680e-01 8.192365926179191460e-01 \
                 0.000000000000000000e+00 0.000000000000000000e+00 0.000000000000000000e+00 1.000000000000000000e+00\n",
                [-0.35691592145645423, -0.6602722315763628, 0.8192365926179191],
                DVec3::new(0.3023788796086531, 0.6482186796076165, -0.6988415818870353),
            ),
        ] {
            let found = poses(text).unwrap_or_else(|e| panic!("{origin}: {e}"));
            let [(found_eye, rotation)] = found[..] else { panic!("{origin}: {found:?}") };
            assert_eq!(found_eye, DVec3::from(eye), "{origin}");
            let found = rotation.normalize() * DVec3::Z;
            // matrices of six digits are as far from orthogonal
            assert!((found - forward.normalize()).length() < 2e-6, "{origin}: {found}");
        }
    }

    #[test]
    fn a_wrong_matrix_is_refused() {
        let [a, b, c, d] = MATRIX;
        for (text, says) in [
            (format!("{a}\n{b}\n{c}\n"), "line 1: the matrix from here on must be four lines of 4 numbers"),
            (format!("0 0 1\n{a}\n{b}\n{c}\n{d}\n1 1 2\n{a}\n"), "line 6: the matrix from here on"),
            (format!("{a} {b} {c} 0 0 0 2\n"), "line 1: the last row of the matrix must be 0 0 0 1"),
            ("1 2 3 4 5\n".into(), "line 1: 5 numbers; TUM's poses have 8"),
        ] {
            let error = poses(&text).unwrap_err();
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
