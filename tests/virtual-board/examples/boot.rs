use virtual_board::{board::*, closed_loop::Shared, time::*};
fn main() {
    let rig = Shared::at_rest(2160);
    let mut b = Board::new(load(None).unwrap(), Box::new(rig)).unwrap();
    let t = std::time::Instant::now();
    let r = b.run_for(5 * SECOND);
    for l in &b.log { println!("{l}"); }
    println!("{r:?} now {} us, {} instr, {:?}", b.now()/US, b.cpu.instructions(), t.elapsed());
    println!("term: {}", b.take_terminal());
}
