//! Names with `{frame:04}` and `{camera.pieces}` in them.

/// Puts values where their keys stand in braces; `{key:04}` makes a number as wide by zeros, `{{` is a brace.
pub fn fill(text: &str, value_of: impl Fn(&str) -> Option<String>) -> Result<String, String> {
    let mut filled = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        filled.push_str(&rest[..at]);
        let brace = &rest[at..=at];
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix(brace) {
            filled.push_str(brace);
            rest = after;
            continue;
        }
        let (Some(end), "{") = (rest.find('}'), brace) else {
            return Err(format!("unmatched brace in {text:?}; write {{frame}} for a value, or {{{{ for a brace"));
        };
        let (key, width) = rest[..end].split_once(':').unwrap_or((&rest[..end], ""));
        let value =
            value_of(key).ok_or_else(|| format!("{key:?} in {text:?} is neither frame, nor image, nor a swept key"))?;
        let width = match width {
            "" => 0,
            digits => digits
                .parse()
                .ok()
                .filter(|w| *w <= 64)
                .ok_or_else(|| format!("{digits:?} is not a width; write one from 0 to 64, for example 04"))?,
        };
        let number: Option<f64> = value.parse().ok();
        filled.push_str(&number.filter(|_| width > 0).map_or(value, |n| format!("{n:0width$}")));
        rest = &rest[end + 1..];
    }
    Ok(filled + rest)
}

/// What is left of a value in the name of a file.
pub fn plain(value: &str) -> String {
    let kept = |c: char| c.is_alphanumeric() || "._+-".contains(c);
    let text: String = value.chars().map(|c| if kept(c) { c } else { '_' }).collect();
    text.trim_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_filled() {
        let value = |key: &str| match key {
            "frame" => Some("7".to_owned()),
            "half" => Some("7.5".to_owned()),
            "camera.kind" => Some("mesh".to_owned()),
            _ => None,
        };
        for (text, expected) in [
            ("out.png", "out.png"),
            ("{frame:04}.png", "0007.png"),
            ("{half:05}-{frame}{{x}}", "007.5-7{x}"),
            ("{camera.kind:04}/{frame}", "mesh/7"),
        ] {
            assert_eq!(fill(text, value).unwrap(), expected);
        }
        for (text, says) in [("{frame", "unmatched brace"), ("a}", "unmatched brace"), ("{fram}", "a swept key")] {
            assert!(fill(text, value).unwrap_err().contains(says), "{text}");
        }
        assert!(fill("{frame:x}", value).unwrap_err().contains("not a width"));
        assert_eq!((plain("[0, 1.5]"), plain("\"a b\"")), ("0__1.5".to_owned(), "a_b".to_owned()));
    }
}
