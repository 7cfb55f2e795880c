//! `FileStorage` as XML: elements of `<opencv_storage>` as a tree; lists are numbers separated by spaces.

use super::document::Tree;
use indexmap::IndexMap;
use roxmltree::Node;

/// The elements in `node`, or its text if it has none.
///
/// # Errors
/// Two elements of one name.
pub fn tree(node: Node) -> Result<Tree, String> {
    let mut entries = IndexMap::new();
    for child in node.children().filter(Node::is_element) {
        let name = child.tag_name().name();
        // an element of a list; calibrations have no keys in lists
        if name != "_" && entries.insert(name.to_owned(), tree(child)?).is_some() {
            return Err(format!("<{name}> is there twice"));
        }
    }
    let text = || Tree::Text(node.text().unwrap_or_default().trim().trim_matches('"').to_owned());
    Ok(if entries.is_empty() { text() } else { Tree::Table(entries) })
}
