//! `pt326 identify`.
