//! The `dynid` command.

/// A diagnosis makes and forgets long columns on several threads, for which the allocator of a system is not made: it takes a
/// sixth of the time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    dynid::commands::run()
}
