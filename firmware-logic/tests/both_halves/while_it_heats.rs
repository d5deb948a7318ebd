//! While the heater may be on: the mark stands, the flash is left alone, a stop overtakes, and nothing is started anew.

use fdi_core::Command;
use firmware_logic::console::board::ConsoleBoard;
use firmware_logic::console::{Board, BoardError};
use firmware_logic::control_loop::{Denial, Order, OrderKind, next_order};
use firmware_logic::reset_cause::Restart;
use firmware_logic::settings::store::{SaveError, Store};
use heapless::spsc::Queue;

use crate::flash::Flash;
use crate::{TestChip, at_rest, heating, now};

#[test]
fn the_mark_stands_before_the_heater_is_on_and_goes_when_it_is_off_and_nothing_is_latched() {
    let mut board = heating();
    assert_eq!(board.chip.stalls, 1, "marked, with the output off");
    now(board.settle());
    assert_eq!(board.chip.stalls, 1, "it heats: the mark stands");
    board.chip.output.open = true;
    board.chip.output.enabled = false; // what the chip does by itself
    board.chip.tick(None).expect("no order");
    now(board.settle());
    assert_eq!(board.chip.stalls, 1, "locked out: the mark stands");
    board.chip.output.open = false;
    now(board.command(Command::Acknowledge)).expect("released");
    now(board.settle());
    assert_eq!(board.chip.stalls, 2);
    now(board.settle());
    assert_eq!(board.chip.stalls, 2, "taken away once");
}

#[test]
fn without_a_mark_nothing_arms() {
    let mut board = at_rest();
    let mut flash = Flash::new();
    flash.cut_at(0);
    board = ConsoleBoard::new(board.chip, Store::new(flash), false);
    assert_eq!(now(board.command(Command::Arm)), Err(Denial::NoMark));
    assert!(!board.chip.output.enabled);
}

#[test]
fn neither_flash_nor_option_bytes_are_written_while_it_may_heat() {
    let mut board = heating();
    assert_eq!(now(board.save()), Err(SaveError::Heating));
    assert_eq!(board.set_brown_out_level(), Err(SaveError::Heating));
    now(board.command(Command::Stop)).expect("always");
    now(board.check()).expect("begins");
    assert!(!board.chip.output.enabled, "it rests first");
    assert_eq!(now(board.save()), Err(SaveError::Heating), "a pulse may come meanwhile");
    assert_eq!(board.set_brown_out_level(), Err(SaveError::Heating));
    now(board.command(Command::Stop)).expect("always");
    while board.status().may_heat() {
        board.chip.tick(None).expect("no order");
    }
    assert_eq!((now(board.save()), board.set_brown_out_level()), (Ok(()), Ok(())));
}

/// The last tick does not know of it yet; whoever enabled it, nothing may stall the core now.
#[test]
fn an_output_that_is_enabled_may_heat_whatever_the_last_tick_says() {
    let mut board = at_rest();
    board.chip.output.enabled = true;
    assert!(!board.status().may_heat());
    assert_eq!(now(board.save()), Err(SaveError::Heating));
    assert_eq!(board.set_brown_out_level(), Err(SaveError::Heating));
    assert_eq!(now(Board::restart(&mut board, Restart::Streaming)), Err(BoardError::NotOff));
    board.chip.output.enabled = false;
    assert_eq!((now(board.save()), board.set_brown_out_level()), (Ok(()), Ok(())));
}

#[test]
fn a_save_waits_for_the_tick_that_knows_of_the_stop() {
    let mut board = heating();
    board.stop();
    assert!(board.status().is_heating() && !board.chip.output.enabled);
    assert_eq!(now(board.save()), Ok(()));
    assert!(!board.status().is_heating());
}

#[test]
fn a_stop_overtakes_and_forgets_what_heats() {
    let mut queue: Queue<Order, 4> = Queue::new();
    let (mut give, mut waiting) = queue.split();
    let mut kinds = |stop, orders: &[Order]| {
        orders.iter().for_each(|order| give.enqueue(order.clone()).expect("room"));
        core::iter::once(next_order(stop, &mut waiting))
            .chain(core::iter::from_fn(|| next_order(false, &mut waiting)).map(Some))
            .map(|order| order.map(|order| order.kind()))
            .collect::<Vec<_>>()
    };
    let (arm, ack) = (Order::Command(Command::Arm), Order::Command(Command::Acknowledge));
    let (armed, acknowledged) = (Some(arm.kind()), Some(ack.kind()));
    let stop = Some(OrderKind::Command(Command::Stop));
    assert_eq!(kinds(false, &[arm.clone(), ack.clone()]), [armed, acknowledged]);
    assert_eq!(kinds(true, &[arm, Order::Check, ack]), [stop, acknowledged]);
    assert_eq!(kinds(true, &[]), [stop]);
    assert_eq!(kinds(false, &[]), [None]);
}

#[test]
fn a_restart_is_refused_while_it_heats_checks_or_is_latched() {
    let restart = |board: &mut ConsoleBoard<TestChip, Flash>| now(Board::restart(board, Restart::Streaming));
    assert_eq!(restart(&mut heating()), Err(BoardError::NotOff));

    let mut checking = at_rest();
    now(checking.check()).expect("begins");
    assert_eq!(restart(&mut checking), Err(BoardError::NotOff));

    let mut cut = heating();
    cut.chip.output.enabled = false; // the interlock opens
    assert_eq!(restart(&mut cut), Err(BoardError::Latched), "it waits for the tick that latches it");
    assert_eq!(cut.chip.restarted, None);
    now(cut.command(Command::Acknowledge)).expect("acknowledged");
    let _ = restart(&mut cut);
    assert_eq!(cut.chip.restarted, Some(Restart::Streaming));
}
