//! x
use virtual_board::{board::*, scene::*, inject, time::*};
use std::time::Instant;
fn main() {
    let t = Instant::now(); let image = load(None).unwrap(); println!("load {:?}", t.elapsed());
    let t = Instant::now(); let _s = Scene::powered_up(image.clone()).unwrap(); println!("new {:?}", t.elapsed());
    let t = Instant::now(); let mut s = Scene::heating(image.clone()).unwrap(); println!("heating {:?}", t.elapsed());
    let t = Instant::now(); s.board.run_for(10*SECOND).unwrap(); println!("10s {:?}", t.elapsed());
    let t = Instant::now(); 
    let poll = inject::poll_function(&s.board, "console").unwrap(); s.board.cpu.watch(poll).unwrap();
    let i0 = s.board.cpu.instructions(); let n0=s.board.now(); let mut hits=0;
    let until = s.board.now()+4000*MS;
    while s.board.run_to(until).unwrap().is_some() { hits+=1; if hits<20 {println!("hit at {} us pc {} exc {}", (s.board.now()-n0)/US, s.board.image.describe(s.board.cpu.pc()), s.board.cpu.exception()); } let b = s.board.cpu.link().unwrap(); s.board.cpu.jump(b);} s.board.cpu.unwatch().unwrap();
    println!("hits {hits} instr {}", s.board.cpu.instructions()-i0);
 println!("silence {:?}", t.elapsed());
    println!("{:?} off {:?}", s.board.resets, s.board.chip().heater_log.iter().rev().take(4).collect::<Vec<_>>());
    let t = Instant::now(); s.board.run_for(10*SECOND).unwrap(); println!("10s {:?}", t.elapsed());
    for l in s.board.log.iter().filter(|l| l.level!="debug").rev().take(12) { println!("{l}"); }
}
