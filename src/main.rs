//! The `dynid` command.

/// A diagnosis makes and forgets long columns on several threads, for which the allocators of systems are not made
/// (`docs/performance.md`).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    dynid::commands::run()
}
