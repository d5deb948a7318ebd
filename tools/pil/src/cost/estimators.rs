//! One update of recursive least squares: ours, the peers' on the same samples, and ours against the model order.

use core::fmt::{self, Write};

use fdi_core::identify::rls::{Rls, RlsState, Update};

use super::Stopwatch;
use crate::peers::{self, FullMatrix, Regressor, Textbook};
use crate::recording::Recording;

/// Samples given to a peer: they take the same path on each, and double precision is slow to trace.
const PEER_SAMPLES: usize = 500;

/// Counts every estimator.
pub(super) fn count(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    ours::<6>(watch, recording, out, "RLS update, n = 6", recording.len())?;
    others(watch, recording, out)?;
    ours::<2>(watch, recording, out, "RLS update, n = 2", PEER_SAMPLES)?;
    ours::<4>(watch, recording, out, "RLS update, n = 4", PEER_SAMPLES)?;
    ours::<8>(watch, recording, out, "RLS update, n = 8", PEER_SAMPLES)?;
    ours::<10>(watch, recording, out, "RLS update, n = 10", PEER_SAMPLES)?;
    ours::<12>(watch, recording, out, "RLS update, n = 12", PEER_SAMPLES)?;
    ours::<14>(watch, recording, out, "RLS update, n = 14", PEER_SAMPLES)?;
    ours::<16>(watch, recording, out, "RLS update, n = 16", PEER_SAMPLES)
}

fn ours<const N: usize>(
    watch: &mut Stopwatch,
    recording: &Recording,
    out: &mut impl Write,
    name: &str,
    samples: usize,
) -> fmt::Result {
    let rls = peers::ours::<N>();
    let mut state = rls.start();
    let mut regressor = Regressor::default();
    watch.pass(out, [name], samples, |watch, k| {
        let y = regressor.output(&recording.row(k));
        watch.time(0, || update(&rls, &mut state, &regressor.phi, y));
        regressor.shift(&recording.row(k));
    })
}

fn others(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let mut regressor = Regressor::<6>::default();
    let mut full = FullMatrix::default();
    watch.pass(out, ["peer, n = 6: full matrix, arrays, f32"], PEER_SAMPLES, |watch, k| {
        let y = regressor.output(&recording.row(k));
        watch.time(0, || full_matrix(&mut full, &regressor.phi, y));
        regressor.shift(&recording.row(k));
    })?;
    let mut regressor = Regressor::<6>::default();
    let mut single = Textbook::default();
    watch.pass(out, ["peer, n = 6: nalgebra, textbook, f32"], PEER_SAMPLES, |watch, k| {
        let y = regressor.output(&recording.row(k));
        watch.time(0, || textbook_single(&mut single, &regressor.phi, y));
        regressor.shift(&recording.row(k));
    })?;
    let mut regressor = Regressor::<6>::default();
    let mut double = Textbook::default();
    watch.pass(out, ["peer, n = 6: nalgebra, textbook, f64"], PEER_SAMPLES, |watch, k| {
        let (phi, y) = (regressor.phi.map(f64::from), f64::from(regressor.output(&recording.row(k))));
        watch.time(0, || textbook_double(&mut double, &phi, y));
        regressor.shift(&recording.row(k));
    })
}

#[inline(never)]
pub(super) fn update<const N: usize>(
    rls: &Rls<N>,
    state: &mut RlsState<N>,
    phi: &[f32; N],
    y: f32,
) -> Update {
    rls.step(state, phi, y)
}

#[inline(never)]
pub(super) fn full_matrix(peer: &mut FullMatrix<6>, phi: &[f32; 6], y: f32) -> f32 {
    peer.step(phi, y)
}

#[inline(never)]
pub(super) fn textbook_single(peer: &mut Textbook<f32, 6>, phi: &[f32; 6], y: f32) -> f32 {
    peer.step(phi, y)
}

#[inline(never)]
pub(super) fn textbook_double(peer: &mut Textbook<f64, 6>, phi: &[f64; 6], y: f64) -> f64 {
    peer.step(phi, y)
}
