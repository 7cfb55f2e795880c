//! Lists of 3-D points: .npy of shape N x 3, or text with one point per line.

#[cfg(feature = "cli")]
use super::npy::read_npy_rows;
use crate::input::{Error, Loading, Result};
use glam::DVec3;
use std::path::Path;

/// Largest text file, bytes: about 10^8 points.
const MAX_TEXT: u64 = 1 << 33;

/// Reads finite points: .npy of f32 or f64, N x 3 in C order; or .csv, .txt, .xyz with three numbers per line, separated by
/// commas, semicolons or blanks. Empty lines, lines that start with `#` and a first line of names are skipped.
///
/// # Errors
/// [`Error::Input`] naming the file and the line or row: not there, another format, or a value that is no finite number.
#[cfg(feature = "cli")]
pub fn read_points(path: &Path, loading: &Loading) -> Result<Vec<DVec3>> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let wrong = |why: String| Error::input(format!("{}: {why}", path.display()));
    match extension.as_deref() {
        Some("npy") => {
            let points: Vec<DVec3> = read_npy_rows(path, loading)?.into_iter().map(DVec3::from_array).collect();
            match points.iter().position(|p| !p.is_finite()) {
                Some(index) => Err(wrong(format!("point {index} is not finite; leave it out"))),
                None => Ok(points),
            }
        }
        Some("csv" | "txt" | "xyz") => read_text(path, loading).and_then(|text| text.only_points()).map_err(wrong),
        _ => Err(wrong("points are read from .npy, .csv, .txt or .xyz files only".into())),
    }
}

/// Points of a text, with what each line has behind them.
pub struct TextPoints {
    pub points: Vec<DVec3>,
    /// The fourth to sixth number of each line; `None` where a line has fewer or other words.
    pub triples: Option<Vec<[f64; 3]>>,
    /// The first line that has more than three columns, from 1.
    wide_line: Option<(usize, String)>,
}

impl TextPoints {
    /// Whether lines have more than three columns.
    pub fn has_more(&self) -> bool {
        self.wide_line.is_some()
    }

    #[cfg(feature = "cli")]
    fn only_points(self) -> std::result::Result<Vec<DVec3>, String> {
        match self.wide_line {
            Some((number, line)) => Err(not_three(number, &line)),
            None => Ok(self.points),
        }
    }
}

fn not_three(number: usize, line: &str) -> String {
    format!("line {number}: {line:.40?} is not three finite numbers, as 1.5 2 -3")
}

/// Reads text as [`read_points`] does, with more columns than three: programs write colours, normals and intensities behind x y z. A first line
/// that begins with `//` is skipped, too.
///
/// # Errors
/// Those of [`read_points`].
pub fn read_text_points(path: &Path, loading: &Loading) -> Result<TextPoints> {
    read_text(path, loading).map_err(|why| Error::input(format!("{}: {why}", path.display())))
}

fn read_text(path: &Path, loading: &Loading) -> std::result::Result<TextPoints, String> {
    let cannot = |e| format!("cannot be read: {e}; check the path");
    let start = loading.prefix(path).map_err(cannot)?;
    let bytes = start.length();
    if bytes > MAX_TEXT {
        return Err(format!("{bytes} bytes are over the limit of {MAX_TEXT}; use .npy"));
    }
    let no_text = || "is no UTF-8 text; write plain text".to_string();
    start.check_text().map_err(|_| no_text())?;
    let text = String::from_utf8(start.read_all().map_err(cannot)?).map_err(|_| no_text())?;
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    let mut read = TextPoints { points: Vec::new(), triples: Some(Vec::new()), wide_line: None };
    let mut first = true;
    for (number, line) in lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')) {
        let is_part = |c: char| c == ',' || c == ';' || c.is_whitespace();
        let values: Vec<Option<f64>> = line.split(is_part).filter(|v| !v.is_empty()).map(|v| v.parse().ok()).collect();
        let names = first && (values.iter().all(Option::is_none) || line.starts_with("//"));
        first = false;
        match values[..] {
            _ if names => {}
            [Some(x), Some(y), Some(z), ref more @ ..] if DVec3::new(x, y, z).is_finite() => {
                read.points.push(DVec3::new(x, y, z));
                if !more.is_empty() && read.wide_line.is_none() {
                    read.wide_line = Some((number, line.to_owned()));
                }
                match (more, &mut read.triples) {
                    ([Some(a), Some(b), Some(c), ..], Some(triples)) => triples.push([*a, *b, *c]),
                    _ => read.triples = None,
                }
            }
            _ => return Err(not_three(number, line)),
        }
    }
    Ok(read)
}

#[cfg(test)]
mod tests {
    use super::super::write_npy;
    use super::*;

    fn read(name: &str, text: &str) -> Result<Vec<DVec3>> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(name);
        std::fs::write(&path, text).unwrap();
        read_points(&path, &Loading::default())
    }

    #[test]
    fn text_in_the_usual_forms() {
        let expected = vec![DVec3::new(1.0, -2.5, 3e4), DVec3::ZERO];
        for text in ["1 -2.5 3e4\n0 0 0", "x,y,z\n1,-2.5,3e4\n0,0,0\n", "# a list\r\n\r\n 1;\t-2.5 ; 3e4 \r\n0\t0\t0"] {
            assert_eq!(read("p.csv", text).unwrap(), expected, "{text:?}");
        }
        assert!(read("p.txt", "").unwrap().is_empty());
    }

    #[test]
    fn columns_behind_the_points() {
        let read = |text: &str| {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("p.xyz");
            std::fs::write(&path, text).unwrap();
            read_text_points(&path, &Loading::default())
        };
        let colored = read("//X Y Z R G B I\n1 2 3 0.5 0 1 9\n4 5 6 0 0 0 8\n").unwrap();
        assert_eq!(colored.points, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]);
        assert_eq!(colored.triples, Some(vec![[0.5, 0.0, 1.0], [0.0; 3]]));
        let with_names = read("x,y,z,intensity\n1,2,3,40\n2,2,3,tree").unwrap();
        assert_eq!((with_names.points.len(), with_names.triples.is_none(), with_names.has_more()), (2, true, true));
        assert!(!read("1 2 3").unwrap().has_more());
        assert!(read("1 2 3 4\n1 nan 3 4").err().unwrap().to_string().contains("line 2"));
    }

    #[test]
    fn wrong_text_is_refused_by_its_line() {
        for (text, line) in
            [("1 2 3\n1 2", "line 2"), ("1 2 3 4", "line 1"), ("x y z\na b c", "line 2"), ("1 2 nan", "line 1")]
        {
            let error = read("p.xyz", text).unwrap_err().to_string();
            assert!(error.contains(line) && error.contains("three finite numbers"), "{error}");
        }
        assert!(read("p.obj", "").unwrap_err().to_string().contains(".npy, .csv"));
        assert!(
            read_points(Path::new("no/such.txt"), &Loading::default())
                .unwrap_err()
                .to_string()
                .contains("cannot be read")
        );
    }

    #[test]
    fn arrays_of_three_columns() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("p.npy");
        write_npy(&path, &[2, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        assert_eq!(
            read_points(&path, &Loading::default()).unwrap(),
            [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]
        );
        write_npy(&path, &[1, 3], &[1.0, f64::NAN, 3.0]).unwrap();
        assert!(read_points(&path, &Loading::default()).unwrap_err().to_string().contains("point 0 is not finite"));
        write_npy(&path, &[3, 2], &[0.0; 6]).unwrap();
        assert!(read_points(&path, &Loading::default()).unwrap_err().to_string().contains("must be N x 3"));
        let whole = std::fs::read(&path).unwrap();
        write_npy(&path, &[2, 3], &[0.0; 6]).unwrap();
        std::fs::write(&path, &std::fs::read(&path).unwrap()[..whole.len() - 9]).unwrap();
        assert!(read_points(&path, &Loading::default()).unwrap_err().to_string().contains("ends early"));
    }
}
