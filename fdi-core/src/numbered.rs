//! A table of stable numbers and names for the variants of an enum: one place for logs, traces, pages and boards.

/// `numbered! { Type from 0; Self::Variant => 0, "name"; .. }`, or with a sentence for people behind each name: numbers go up by one, in the order of the table. Recordings hold both, so a new
/// variant comes last, and none is ever changed. A variant without a row does not compile.
macro_rules! numbered {
    ($type:ident from $first:literal; $($variant:pat => $number:literal, $name:literal, $words:literal;)*) => {
        numbered! { $type from $first; $($variant => $number, $name;)* }

        impl $type {
            /// What they say, for people, in the order of their numbers.
            pub const WORDS: [&'static str; Self::NAMES.len()] = [$($words),*];

            /// What it says, for people.
            pub const fn words(self) -> &'static str {
                match self {
                    $($variant => $words,)*
                }
            }
        }
    };
    ($type:ident from $first:literal; $($variant:pat => $number:literal, $name:literal;)*) => {
        impl $type {
            /// Names in the order of their numbers, the first of which is
            #[doc = concat!(stringify!($first), ".")]
            pub const NAMES: [&'static str; [$($number),*].len()] = [$($name),*];

            /// Its number in recordings. It never changes.
            pub const fn number(&self) -> u32 {
                match self {
                    $($variant => $number,)*
                }
            }

            /// Its name in traces, logs and files.
            pub const fn name(&self) -> &'static str {
                match self {
                    $($variant => $name,)*
                }
            }

            /// Number and name.
            pub const fn numbered(&self) -> (u32, &'static str) {
                (self.number(), self.name())
            }
        }

        const _: () = {
            let (numbers, mut i) = ([$($number),*], 0);
            while i < numbers.len() {
                assert!(numbers[i] == $first + i, "the numbers of a table go up by one");
                i += 1;
            }
        };
    };
}

pub(crate) use numbered;
