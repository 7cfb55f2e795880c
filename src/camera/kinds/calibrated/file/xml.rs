//! `FileStorage` as XML: elements of `<opencv_storage>`; lists are numbers separated by spaces.

use super::opencv::{Keys, Matrix};
use roxmltree::{Document, Node};
use std::str::FromStr;

type Result<T> = std::result::Result<T, String>;

pub fn keys(text: &str) -> Result<Keys> {
    let document = Document::parse(text).map_err(|e| e.to_string())?;
    let root = document.root_element();
    if !root.has_tag_name("opencv_storage") {
        return Err(format!("its root element is <{}>, not <opencv_storage>", root.tag_name().name()));
    }
    Ok(Keys {
        image_width: number(need(root, "image_width")?)?,
        image_height: number(need(root, "image_height")?)?,
        camera_matrix: matrix(need(root, "camera_matrix")?)?,
        distortion_coefficients: matrix(need(root, "distortion_coefficients")?)?,
        distortion_model: child(root, "distortion_model")?.map(|node| text_of(node).trim_matches('"').to_string()),
        fisheye_model: child(root, "fisheye_model")?.map(number).transpose()?,
    })
}

fn child<'a>(parent: Node<'a, 'a>, name: &str) -> Result<Option<Node<'a, 'a>>> {
    let mut all = parent.children().filter(|c| c.has_tag_name(name));
    match (all.next(), all.next()) {
        (first, None) => Ok(first),
        _ => Err(format!("<{name}> is there twice")),
    }
}

fn need<'a>(parent: Node<'a, 'a>, name: &str) -> Result<Node<'a, 'a>> {
    child(parent, name)?.ok_or_else(|| format!("<{}> has no <{name}>", parent.tag_name().name()))
}

fn text_of<'a>(node: Node<'a, 'a>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

fn read<T: FromStr>(node: Node, word: &str) -> Result<T> {
    word.parse().map_err(|_| format!("<{}>: {word:?} is not a number in range", node.tag_name().name()))
}

fn number<T: FromStr>(node: Node) -> Result<T> {
    read(node, text_of(node))
}

fn matrix(node: Node) -> Result<Matrix> {
    let data = need(node, "data")?;
    Ok(Matrix {
        rows: number(need(node, "rows")?)?,
        cols: number(need(node, "cols")?)?,
        data: text_of(data).split_ascii_whitespace().map(|word| read(data, word)).collect::<Result<_>>()?,
    })
}
