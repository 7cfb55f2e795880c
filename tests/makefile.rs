//! What a person types is there: every target that the Makefile names has a recipe.

/// The targets that `.PHONY` names, and those that have a recipe.
fn targets(text: &str) -> (Vec<&str>, Vec<&str>) {
    let named = text.lines().filter_map(|l| l.strip_prefix(".PHONY:")).flat_map(str::split_whitespace).collect();
    let lines: Vec<&str> = text.lines().collect();
    let rules = lines.windows(2).filter(|pair| pair[1].starts_with('\t') && !pair[0].starts_with('\t'));
    (named, rules.filter_map(|pair| pair[0].split(':').next()).collect())
}

#[test]
fn every_target_has_a_recipe() {
    let text = include_str!("../Makefile");
    let (named, ruled) = targets(text);
    assert!(named.contains(&"check") && named.contains(&"driver"), "{named:?}");
    for target in &named {
        assert!(ruled.contains(target), "make {target} does nothing");
    }
    // the end of the file cut off, as an editor may
    let (cut, _) = text.split_once("check: ").unwrap();
    assert!(!targets(cut).1.contains(&"driver"));
}
