//! The defmt log over RTT: a ring buffer that the debug probe reads from memory while the program runs.
//!
//! A frame goes in whole or not at all, and what does not fit is counted: a probe that is slow, or not there, neither
//! delays anything nor leaves half a frame behind. Only thread mode logs, one task at a time, so no interrupt is ever
//! masked for a log line; a log call from an interrupt would be dropped and counted, too.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering, fence};

use cortex_m::peripheral::SCB;
use cortex_m::peripheral::scb::VectActive;

/// Four seconds of tick records.
const SIZE: usize = 4096;

/// SEGGER's control block, with one channel up and none down. The probe finds it by its symbol.
#[repr(C)]
struct ControlBlock {
    id: [u8; 16],
    channels_up: usize,
    channels_down: usize,
    name: *const u8,
    buffer: *mut [u8; SIZE],
    size: usize,
    /// Where the next byte goes; ours.
    write: AtomicUsize,
    /// The next byte that the probe reads; the probe's.
    read: AtomicUsize,
    /// The probe may ask for blocking here; it is not obeyed.
    flags: AtomicUsize,
}

// SAFETY: the pointers never change; the buffer is written by the logger alone, see `Buffer`.
unsafe impl Sync for ControlBlock {}

struct Buffer(UnsafeCell<[u8; SIZE]>);

// SAFETY: written only between `acquire` and `release`, which admit one context at a time; the probe reads what lies
// behind the write offset, which moves when a frame is complete.
unsafe impl Sync for Buffer {}

static BUFFER: Buffer = Buffer(UnsafeCell::new([0; SIZE]));

#[unsafe(no_mangle)]
static _SEGGER_RTT: ControlBlock = ControlBlock {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    channels_up: 1,
    channels_down: 0,
    name: c"defmt".as_ptr().cast(),
    buffer: BUFFER.0.get(),
    size: SIZE,
    write: AtomicUsize::new(0),
    read: AtomicUsize::new(0),
    flags: AtomicUsize::new(0),
};

/// Frames that did not fit since the start.
static DROPPED: AtomicU32 = AtomicU32::new(0);
/// A frame is being written.
static BUSY: AtomicBool = AtomicBool::new(false);
/// Where the frame being written has got to, and whether it still fits.
static CURSOR: AtomicUsize = AtomicUsize::new(0);
static FITS: AtomicBool = AtomicBool::new(false);

struct Encoder(UnsafeCell<defmt::Encoder>);

// SAFETY: used only between `acquire` and `release`, which admit one context at a time.
unsafe impl Sync for Encoder {}

static ENCODER: Encoder = Encoder(UnsafeCell::new(defmt::Encoder::new()));

/// Frames dropped since the start.
pub(crate) fn dropped() -> u32 {
    DROPPED.load(Ordering::Relaxed)
}

/// Appends to the frame being written, unless it has ceased to fit.
fn append(bytes: &[u8]) {
    let read = _SEGGER_RTT.read.load(Ordering::Acquire).min(SIZE - 1);
    let mut cursor = CURSOR.load(Ordering::Relaxed).min(SIZE - 1);
    for &byte in bytes {
        let next = if cursor + 1 == SIZE { 0 } else { cursor + 1 };
        if next == read {
            FITS.store(false, Ordering::Relaxed); // full: one byte stays free, or full would look like empty
            return;
        }
        // SAFETY: the cursor is within the buffer, and the probe does not read here before the frame is complete.
        unsafe { BUFFER.0.get().cast::<u8>().add(cursor).write(byte) };
        cursor = next;
    }
    CURSOR.store(cursor, Ordering::Relaxed);
}

fn append_if_fitting(bytes: &[u8]) {
    if FITS.load(Ordering::Relaxed) {
        append(bytes);
    }
}

#[defmt::global_logger]
struct Logger;

// SAFETY: `acquire` admits thread mode alone, and there one task at a time (nothing in a log call awaits).
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let in_thread_mode = SCB::vect_active() == VectActive::ThreadMode;
        if !in_thread_mode {
            return; // its writes are ignored below: the frame of the thread that it interrupts must not be mixed up
        }
        BUSY.store(true, Ordering::Relaxed);
        CURSOR.store(_SEGGER_RTT.write.load(Ordering::Relaxed), Ordering::Relaxed);
        FITS.store(true, Ordering::Relaxed);
        // SAFETY: one context at a time, see above.
        unsafe { (*ENCODER.0.get()).start_frame(append_if_fitting) };
    }

    unsafe fn flush() {}

    unsafe fn release() {
        if !may_write() {
            DROPPED.fetch_add(1, Ordering::Relaxed);
            return;
        }
        // SAFETY: one context at a time, see above.
        unsafe { (*ENCODER.0.get()).end_frame(append_if_fitting) };
        if FITS.load(Ordering::Relaxed) {
            fence(Ordering::SeqCst); // the bytes before the offset that shows them
            _SEGGER_RTT.write.store(CURSOR.load(Ordering::Relaxed), Ordering::Release);
        } else {
            DROPPED.fetch_add(1, Ordering::Relaxed);
        }
        BUSY.store(false, Ordering::Relaxed);
    }

    unsafe fn write(bytes: &[u8]) {
        if may_write() {
            // SAFETY: one context at a time, see above.
            unsafe { (*ENCODER.0.get()).write(bytes, append_if_fitting) };
        }
    }
}

fn may_write() -> bool {
    BUSY.load(Ordering::Relaxed) && SCB::vect_active() == VectActive::ThreadMode
}

// Not the clock of the tasks: its driver counts overflows by interrupt and loses them while a flash sector is erased.
defmt::timestamp!("{=u64:us}", super::tick_timer::uptime_us());
