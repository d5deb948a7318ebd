//! What was commissioned is in the flash at the next start, unless it was cleared or the rig is simulated.

use fdi_core::Command;
use fdi_core::likelihood::{Commissioned, PARAMETERS};
use firmware_logic::console::Board;
use firmware_logic::console::board::{Chip, ConsoleBoard};
use firmware_logic::notice::Notice;
use firmware_logic::settings::commissioning::Commissioning;
use firmware_logic::settings::store::{SaveError, Store};

use crate::flash::Flash;
use crate::{TestChip, at_rest, heating, now};

/// What the flash of a board has, by its next start.
fn kept(board: ConsoleBoard<TestChip, Flash>) -> Option<Commissioning> {
    now(Store::new(board.into_flash()).commissioning())
}

#[test]
fn a_commissioning_is_written_once_and_only_while_nothing_heats() {
    let models = Commissioned { parameters: [0.3; PARAMETERS] };
    let commissioning = Commissioning { number: 1, models };
    let mut board = heating();
    let stalls = board.chip.stalls;
    board.chip.change(|diagnosis| diagnosis.commissioned(Some(commissioning)));
    now(board.settle());
    assert_eq!(board.chip.stalls, stalls, "it heats");
    board.chip.notices.clear();
    for ticks in [1, 2] {
        board.chip.tick(None).expect("no order");
        let told = board.chip.notices.iter().filter(|notice| matches!(notice, Notice::Commissioning(_)));
        assert_eq!(told.count(), 1, "told once, {ticks} ticks later");
    }
    assert_eq!(board.chip.notices[0], Notice::Commissioning(Some(commissioning)), "before the tick");
    now(board.command(Command::Stop)).expect("always");
    now(board.settle());
    let written = board.chip.stalls;
    assert!(written > stalls);
    now(board.settle());
    assert_eq!(board.chip.stalls, written, "written once");
    assert!(board.status().to_string().contains("\ncommissioning 1\n"));
    assert_eq!(now(board.save()), Ok(()));
    let saved = board.chip.stalls;
    now(board.settle());
    assert!(board.chip.stalls > saved, "a save may have had to erase it");
    assert_eq!(kept(board), Some(commissioning));
}

#[test]
fn a_commissioning_that_is_cleared_is_gone_at_the_next_start_and_one_untrained_is_none() {
    let mut board = at_rest();
    assert!(!board.commission(), "nothing is trained");
    let models = Commissioned { parameters: [0.3; PARAMETERS] };
    board.chip.change(|diagnosis| diagnosis.commissioned(Some(Commissioning { number: 1, models })));
    now(board.settle());
    board.decommission();
    now(board.settle());
    assert_eq!(kept(board), None);
}

/// Models of the simulated rig would be those that the real one is held against later.
#[test]
fn a_board_that_is_simulated_writes_nothing_to_its_flash() {
    let mut board = at_rest();
    board.chip.simulated = true;
    now(board.command(Command::Arm)).expect("arms");
    let models = Commissioned { parameters: [0.3; PARAMETERS] };
    board.chip.change(|diagnosis| diagnosis.commissioned(Some(Commissioning { number: 1, models })));
    now(board.command(Command::Stop)).expect("always");
    now(board.settle());
    assert_eq!(now(board.save()), Err(SaveError::Simulated));
    assert_eq!(board.chip.stalls, 0);
    assert_eq!(kept(board), None);
}
