//! x
use virtual_board::{board::*, scene::*, time::*};
fn main() {
    let image = load(None).unwrap();
    let mut s = Scene::at_rest(image.clone()).unwrap();
    s.board.run_for(SECOND).unwrap();
    println!("at boot {:?}", s.board.take_terminal());
    for l in ["arm ".repeat(40), "a\x01b".into(), "\x03".into(), "ärm".into()] {
        s.board.send(format!("{l}\r").as_bytes());
        s.board.run_for(200 * MS).unwrap();
        println!("{l:?} -> {:?}", s.board.take_terminal());
    }
}
