//! x
use virtual_board::{board::*, closed_loop::Shared, time::*};
use host_sim::{rig::*, scenario::Scenario};
fn main() {
    let rig = Shared::at_rest(2248);
    let mut b = Board::new(load(None).unwrap(), Box::new(rig.clone())).unwrap();
    b.run_for(1 * SECOND+ 30*MS).unwrap();
    for l in b.log.iter().take(12) { println!("{l}"); }
    println!("term: {:?}", b.take_terminal());
    println!("ans: {:?}", b.command("status"));
    let sc = Scenario::default();
    rig.0.borrow_mut().start(Rig::new(&sc.rig, sc.wander, 0.11, 1, &sc.faults));
    println!("ans: {:?}", b.command("arm"));
    let t = std::time::Instant::now();
    let r = b.run_for(100 * SECOND);
    for l in b.log.iter().filter(|l| l.level!="debug").skip(8).take(5) { println!("{l}"); }
    for l in b.log.iter().filter(|l| l.level!="debug").rev().take(5) { println!("{l}"); }
    println!("{r:?} now {} us, {} instr, {:?}", b.now()/US, b.cpu.instructions(), t.elapsed());
    println!("ans: {}", b.command("status").unwrap());
}
