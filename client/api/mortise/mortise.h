#pragma once
/// \file
/// All of mortise for other programs: `find_package(mortise COMPONENTS engine io client)`.
/// | header | component | holds |
/// |---|---|---|
/// | geometry.h | engine | parts, poses, errors |
/// | judge.h | engine | judge, distance, first_contact |
/// | session.h | engine | Session |
/// | io.h | io | load, check, logs |
/// | client.h | client | Client |
///
/// All of it stands in namespace mortise. Values in, values out; there is no global state, and no
/// exception is thrown but for lack of memory.
#include <mortise/client.h>
#include <mortise/geometry.h>
#include <mortise/io.h>
#include <mortise/judge.h>
#include <mortise/session.h>
