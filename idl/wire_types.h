#pragma once
#include "mortisePubSubTypes.h"  // generated from mortise.idl

/// The generated types with what reads and writes their bytes, for who stands outside of this room:
/// tests.
