// SPDX-License-Identifier: MIT
//
// address_space.h: whether limits of the shell (ulimit -v) leave room to compute.
#pragma once

namespace alcap::app {

/// Throws Failure(solver) when the address space is limited to less than libraries need to start. They do not say so:
/// OpenBLAS asks again and again, for ever, for a buffer that it cannot have. Where there is a limit and room, has it
/// take the buffer now, before a large mesh fills the rest.
void check_address_space();

}  // namespace alcap::app
