#pragma once
#include <memory>

#include "client/bot/behaviour.h"

namespace mortise {

/// Puts a shaft into a bore again and again, as a designer does: grabs the part, holds it before
/// the bore about as well as a hand can, has it aligned (a snap, coaxial), and pushes with a hand
/// that trembles. Inserted is what has its shaft in the bore by four fifths of the shorter of the
/// two; what goes no further for two seconds is stuck. Then the part is put back and it begins
/// anew. With free_hand there is no snap: the hand corrects what it sees.
std::unique_ptr<Behaviour> make_guided(const GuidedSettings& settings);

}  // namespace mortise
