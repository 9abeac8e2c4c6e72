#pragma once
#include <memory>

#include "client/bot/behaviour.h"

namespace mortise {

/// Puts a shaft into a bore repeatedly, as a designer does: grabs the part, brings it in front of
/// the bore as well as a hand can, aligns it (a coaxial snap), and pushes with a trembling hand. A
/// part is inserted when its shaft is in the bore by four fifths of the shorter one, and stuck when
/// it does not advance for two seconds. Then it is put back. With free_hand there is no snap: the
/// hand corrects what it sees.
std::unique_ptr<Behaviour> make_guided(const GuidedSettings& settings);

}  // namespace mortise
