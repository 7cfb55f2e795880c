//! The page of the gallery, in Markdown: by the paper that a picture is after, then what no paper has.

use super::beside::{Beside, beside};
use super::moving::{Moving, moving};
use anamorph::internals::tools::example::Example;
use std::fmt::Write;

/// What is said of an example.
pub struct Shown {
    pub example: &'static Example,
    /// Pixels, as its file says.
    pub size: (u32, u32),
    /// The camera's kind.
    pub kind: &'static str,
    /// Triangles and pieces, in words.
    pub counted: String,
    /// Median time of a frame of that size.
    pub ms: f64,
}

/// The papers, as an example's figure names them and by title.
const PAPERS: [(&str, &str); 5] = [
    ("Yu", "Yu, Yu and McMillan 2009, *Towards multi-perspective rasterization*"),
    ("Brosz", "Brosz, Samavati, Carpendale and Sousa 2007, *Single camera flexible projection*"),
    ("Popescu", "Popescu et al., *A flexible framework for interactive multiperspective visualization*"),
    ("Lorenz", "Lorenz and Doellner 2009, *Real-time piecewise perspective projections*"),
    ("Hou", "Hou, Wei, Shum and Guo 2006, *Real-time multi-perspective rendering on graphics hardware*"),
];

/// Pictures that no scene file makes.
const WITHOUT_SCENE: &str = "\n### Gradients\n\n\
    ![Change of depth, and of coverage, by the field of view](guide/gradients/fov.png)\n\n\
    How the picture of a fisheye changes with its field of view: on the left the depth of each pixel, on the right how much of it the nearest edge covers \
    ([gradients](guide/gradients.md)). They find a fisheye's focal lengths and lens coefficients from one image of squares:\n\n\
    | at first, each number 5 % off | after the fit |\n| --- | --- |\n\
    | ![edges of photo and picture, apart](guide/gradients/fit-before.png) | ![edges of photo and picture, on each other](guide/gradients/fit-after.png) |\n\n\
    Red: only the photo shows a square. Blue: only the picture does.\n\n\
    ### Projection and splats\n\n\
    ![A city's points drawn through two slits, beside the rendering](guide/projection/splat.png)\n\n\
    What a pinhole saw of a city, drawn as points through a cross-slit camera, beside what that camera sees of the city itself \
    ([projection](guide/projection.md)).\n";

pub fn name_beside(beside: &Beside) -> String {
    format!("{}-{}", beside.of, beside.name)
}

pub fn page(shown: &[Shown], adapter: &str) -> String {
    let mut text = format!(
        "# Gallery\n\n\
         A scene for each figure of five papers that shows a rendering, and scenes of what none of them has. `anamorph example NAME` writes the scene and its files,\n\
         `anamorph render NAME.toml` renders it. Here all but the rivals' pictures beside them are lit by a sun and a sky, with 16 samples a pixel, or as the mean of 4 frames\n\
         where a camera takes no samples in one; mirrors and lenses cast no shadows. `make gallery` makes this page. The time beside a picture is not that picture's: it is of\n\
         one frame as the scene's file has it, without the sky and of the size named, on {adapter}.\n"
    );
    for (paper, title) in PAPERS {
        // writing to a string does not fail
        let _ = write!(text, "\n## {title}\n");
        let of_paper = |s: &&Shown| s.example.figure.is_some_and(|figure| figure.starts_with(paper));
        shown.iter().filter(of_paper).for_each(|s| text += &section(s));
    }
    text += "\n## What none of the papers has\n";
    shown.iter().filter(|s| s.example.figure.is_none()).for_each(|s| text += &section(s));
    text += WITHOUT_SCENE;
    text
}

fn section(shown: &Shown) -> String {
    let Shown { example, size: (width, height), kind, counted, ms } = shown;
    let (name, shows) = (example.name, example.shows);
    let figure = example.figure.and_then(|f| f.split_once(' ')).map(|(_, figure)| figure);
    let says = match figure {
        Some(figure) if figure.contains(',') => format!("After figures {figure}: {shows}"),
        Some(figure) => format!("After figure {figure}: {shows}"),
        None => shows[..1].to_uppercase() + &shows[1..],
    };
    let mut text = format!(
        "\n### {name}\n\n![{shows}](gallery/{name}.jpg)\n\n\
         {says}. Camera `{kind}`; {counted}; a frame as in the file, {width} x {height} pixels: {ms:.0} ms.\n"
    );
    if let Some(Moving { says, .. }) = moving(name) {
        let _ = write!(text, "\n![{says}](gallery/{name}-moving.png)\n\n{says}\n");
    }
    let beside: Vec<&Beside> = beside(name).collect();
    if !beside.is_empty() {
        let row = |of: &dyn Fn(&Beside) -> String| {
            format!("|{}\n", beside.iter().map(|b| format!(" {} |", of(b))).collect::<String>())
        };
        text += "\n";
        text += &row(&|b| b.shows.to_owned());
        text += &row(&|_| "---".to_owned());
        text += &row(&|b| format!("![{}](gallery/{}.jpg)", b.shows, name_beside(b)));
    }
    let scene = example.scene.trim_end();
    let _ = write!(text, "\n<details><summary>The scene</summary>\n\n```toml\n{scene}\n```\n\n</details>\n");
    text
}
