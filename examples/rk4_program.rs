// SPDX-License-Identifier: MIT
//! The classical method of Runge (1895) and Kutta (1901) as a program in Rust: clothsim-program(7).
//!
//!     rustc --edition 2021 -O rk4_program.rs
//!     clothsim run scenes/hang.json -i program:./rk4_program:dt=0.0002
//!
//! The standard library has no shared memory: mmap and fstat's size are asked from the C library,
//! which each program is linked to. All but `rk4` and `describe` serves any method.
use std::fs::File;
use std::io::{Read, Write};
use std::mem::ManuallyDrop;
use std::os::raw::{c_int, c_void};
use std::os::unix::io::{AsRawFd, FromRawFd};
use std::os::unix::net::UnixStream;
use std::process::exit;

extern "C" {
    fn mmap(at: *mut c_void, length: usize, access: c_int, flags: c_int, file: c_int, offset: i64) -> *mut c_void;
}
const READ_AND_WRITE: c_int = 3;
const SHARED: c_int = 1;

const SOCKET: c_int = 3;
const MEMORY: c_int = 4;
const VERSION: u64 = 1;
const PARTS_ALL: u64 = 0x7fff_ffff;
/// Bytes before the rows, and where texts and the description begin.
const HEAD: usize = 8192;
const TEXT: usize = 4096;
/// First rows of n numbers; x and v follow each other.
const FORCE: usize = 6;
const INVERSE_MASS: usize = 28;

/// A message that comes: its letter and four numbers. This method has no use for the count.
struct Message {
    code: u8,
    values: [f64; 4],
}

/// What clothsim and the program share, and the way between them.
struct Host {
    socket: UnixStream,
    memory: *mut u8,
    n: usize,
}

impl Host {
    /// The socket and the memory that clothsim has left open, or a line of why they are not there.
    fn open() -> Host {
        // not closed here: they belong to the process
        let file = ManuallyDrop::new(unsafe { File::from_raw_fd(MEMORY) });
        let length = file.metadata().map(|info| info.len() as usize).unwrap_or(0);
        if length < HEAD {
            eprintln!("rk4_program: expected to be started by clothsim: -i program:./rk4_program");
            exit(2);
        }
        let start = std::ptr::null_mut();
        let memory = unsafe { mmap(start, length, READ_AND_WRITE, SHARED, file.as_raw_fd(), 0) };
        if memory as isize == -1 {
            eprintln!("rk4_program: the memory cannot be shared");
            exit(1);
        }
        let memory = memory.cast::<u8>();
        let n = unsafe { *memory.cast::<u64>().add(1) } as usize;
        Host { socket: unsafe { UnixStream::from_raw_fd(SOCKET) }, memory, n }
    }

    /// Waits for a message, and ends with clothsim.
    fn receive(&mut self) -> Message {
        let mut bytes = [0u8; 48];
        if self.socket.read_exact(&mut bytes).is_err() {
            exit(0);
        }
        let word = |k: usize| <[u8; 8]>::try_from(&bytes[8 * k..8 * k + 8]).unwrap();
        let value = |k: usize| f64::from_ne_bytes(word(2 + k));
        Message {
            code: u64::from_ne_bytes(word(0)) as u8,
            values: [value(0), value(1), value(2), value(3)],
        }
    }

    fn send(&mut self, letter: u8, count: u64, values: [f64; 4]) {
        let mut bytes = Vec::with_capacity(48);
        bytes.extend((letter as u64).to_ne_bytes());
        bytes.extend(count.to_ne_bytes());
        for value in values {
            bytes.extend(value.to_ne_bytes());
        }
        if self.socket.write_all(&bytes).is_err() {
            exit(0);
        }
    }

    /// A request and its answer. What is asked about is in x and v.
    fn ask(&mut self, letter: u8, count: u64, a: f64, b: f64) -> Message {
        self.send(letter, count, [a, b, 0.0, 0.0]);
        self.receive()
    }

    /// `count` rows of n numbers. clothsim changes them in `ask` alone, which borrows all of Host.
    fn rows(&mut self, first: usize, count: usize) -> &mut [f64] {
        unsafe {
            let row = self.memory.add(HEAD).cast::<f64>().add(first * self.n);
            std::slice::from_raw_parts_mut(row, count * self.n)
        }
    }

    fn put(&mut self, at: usize, bytes: &[u8]) {
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.memory.add(at), bytes.len()) }
    }

    /// The value of an option, which the text has as a line NAME=VALUE.
    fn option(&self, name: &str) -> f64 {
        let text = unsafe { std::slice::from_raw_parts(self.memory.add(TEXT), HEAD - TEXT) };
        let text = text.split(|byte| *byte == 0).next().unwrap_or(&[]);
        let text = String::from_utf8_lossy(text);
        let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='));
        value.and_then(|value| value.parse().ok()).unwrap_or(f64::NAN)
    }

    /// slope = (v, f/m) at t and y.
    fn rate(&mut self, t: f64, y: &[f64], slope: &mut [f64]) {
        let half = 3 * self.n;
        self.rows(0, 6).copy_from_slice(y);
        self.ask(b'F', PARTS_ALL, t, 0.0);
        slope[..half].copy_from_slice(&y[half..]);
        slope[half..].copy_from_slice(self.rows(FORCE, 3));
        let n = self.n;
        let inverse = self.rows(INVERSE_MASS, 1);
        for k in 0..half {
            slope[half + k] *= inverse[k % n];
        }
    }

    /// Ends a step; the state may be another one then.
    fn commit(&mut self, t: f64, h: f64, y: &mut [f64]) {
        self.rows(0, 6).copy_from_slice(y);
        self.ask(b'C', 0, t, h);
        y.copy_from_slice(self.rows(0, 6));
    }
}

/// The step of the method: y at t becomes y at t + h.
fn rk4(host: &mut Host, t: f64, h: f64, y: &mut [f64]) {
    let stages = [(0.0, 1.0), (h / 2.0, 2.0), (h / 2.0, 2.0), (h, 1.0)];
    let (mut slope, mut sum) = (vec![0.0; y.len()], vec![0.0; y.len()]);
    for (reach, weight) in stages {
        let stage: Vec<f64> = y.iter().zip(&slope).map(|(y, k)| y + reach * k).collect();
        host.rate(t + reach, &stage, &mut slope);
        for (sum, k) in sum.iter_mut().zip(&slope) {
            *sum += weight * k;
        }
    }
    for (y, sum) in y.iter_mut().zip(&sum) {
        *y += h / 6.0 * sum;
    }
}

/// Name, order and the one option, at the places of clothsim-program(7).
fn describe(host: &mut Host) {
    let integers: [u64; 7] = [4, 4, 0, 0, 0, 0, 1];
    host.put(TEXT, &integers.map(u64::to_ne_bytes).concat());
    let texts = TEXT + 56;
    host.put(texts, b"rust-rk4\0");
    host.put(texts + 64, b"classical Runge-Kutta method, a program in Rust\0");
    host.put(texts + 320, b"Kutta 1901\0");
    let option = texts + 768;
    host.put(option, b"dt\0");
    host.put(option + 32, b"s\0");
    host.put(option + 48, b"step\0");
    host.put(option + 144, &[1e-3f64, 1e-9, 1.0].map(f64::to_ne_bytes).concat());
}

/// Equal steps that are not longer than dt.
fn advance(host: &mut Host, dt: f64, t0: f64, t1: f64) {
    let count = ((t1 - t0) / dt * (1.0 - 1e-9)).ceil().max(1.0) as u64;
    let h = (t1 - t0) / count as f64;
    let mut y = host.rows(0, 6).to_vec();
    for k in 0..count {
        let end = if k + 1 < count { t0 + (k + 1) as f64 * h } else { t1 };
        rk4(host, t0 + k as f64 * h, h, &mut y);
        host.commit(end, h, &mut y);
    }
}

fn main() {
    let mut host = Host::open();
    let mut dt = f64::NAN;
    describe(&mut host);
    host.send(b'V', VERSION, [0.0; 4]);
    loop {
        let order = host.receive();
        match order.code {
            b'I' => dt = host.option("dt"),
            b'A' => advance(&mut host, dt, order.values[0], order.values[1]),
            b'Q' => return,
            _ => (), // R: nothing is remembered
        }
        host.send(b'D', 0, [0.0; 4]);
    }
}
