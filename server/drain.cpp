#include "server/drain.h"

namespace mortise {

bool Drain::is_ready() {
  if (!begun_ns_) {
    begun_ns_ = clock_.now_ns();
    loop_.begin_drain();
  }
  if (held_.follower_in_step() || !held_.has_follower()) return true;
  return static_cast<double>(clock_.now_ns() - *begun_ns_) * 1e-9 >= kCatchUp_s;
}

void Drain::finish(const std::function<bool()>& goes_on) {
  const bool hands_over = held_.follower_in_step();
  not_in_step_ = !hands_over && held_.has_follower();
  loop_.last_tick(hands_over);
  if (loop_.superseded()) return;  // somebody else was faster
  if (hands_over) {
    end_ = held_.hand_over(goes_on) ? End::kHandedOver : End::kNotTaken;
    return;
  }
  loop_.close();
  held_.finish();
  end_ = End::kAlone;
}

std::string Drain::text(const std::string& session, const std::string& log_file) const {
  const std::string after = " after tick " + std::to_string(loop_.last_report().tick);
  if (end_ == End::kHandedOver) {
    return "drained: the server that stood by leads session '" + session + "'" + after;
  }
  const std::string go_on =
      log_file.empty() ? "; no log was written" : "; go on with --restore " + log_file;
  const std::string drained =
      end_ == End::kNotTaken ? "drained, and the server that stands by was not seen to go on"
      : not_in_step_         ? "drained, and the server that stands by is not in step"
                             : "drained";
  return drained + after + go_on;
}

}  // namespace mortise
