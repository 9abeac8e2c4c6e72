#include "common/io/state/checkpoint.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <utility>

#include "common/base/check.h"
#include "common/io/state/state_fields.h"
#include "common/session/world/scene_edits.h"
#include "common/session/world/surface_rules.h"

namespace mortise {
namespace {

using state_bytes::Reader;
using state_bytes::Writer;
using Memos = std::map<std::uint64_t, PairMemo>;

// Memos in one piece of memory; memos copied in one tick at least; and the ticks after which all
// are copied, whatever their number. What every tick changes goes in one go, in the last of them.
constexpr std::size_t kBlock = 128;
constexpr std::size_t kLeastSlice = 256;
constexpr int kMostSlices = 120;
// Memory that the first frame finds, bytes a part: fetched in the tick, it would cost more than it.
constexpr std::size_t kRoomOfPart = 512;
// A tick looks at so many times the memos that it may copy for some that it has left alone.
constexpr std::size_t kLooks = 4;

void prefetch(const PairMemo& memo) {
  constexpr std::size_t kCacheLine_bytes = 64;  // of x86 and of most ARM
  const auto* bytes = reinterpret_cast<const char*>(&memo);
  for (std::size_t at = 0; at < sizeof memo; at += kCacheLine_bytes) __builtin_prefetch(bytes + at);
}

// 1. bytes

// As a list of PairStatement, which is how it is read; here no text is copied for it.
void put_rules(Writer& out, const World& world) {
  out.count(world.pair_rules.size());
  for (const auto& [ids, rule] : world.pair_rules)
    out(ids, rule.band_a != nullptr, rule.band_b != nullptr, rule.excluded, rule.fit, rule.reason);
}

// All but the memos. The members of a world are named here as those of the rest in state_fields.
void put_frame(Writer& out, const World& world) {
  const auto& [name, tick_rate_hz, threads, policy, max_jump_mm, lease_s, tick, parts, users, pair_rules,
               approved_at_start, may_hold, declared, standing, remarks, rules, shapes, edits,
               restated, guides, next_constraint, next_group, recognized, evaluates, state] = world;
  out(tick, policy, edits, restated);
  out.count(parts.size());
  for (const Part& part : parts) out(part);
  out(users, standing, remarks);
  put_rules(out, world);
  out(guides, next_constraint, next_group, evaluates, *state);
}

void put_memos(Writer& out, const Memos& memos) {
  out.count(memos.size());
  for (const auto& [key, memo] : memos) out(key, memo);
}

// 2. back, checked against the scene

bool is_user(const World& world, UserId user) { return user.value <= world.users.size(); }

bool fits(const World& world, const CertainPlace& place, std::uint32_t a, std::uint32_t b) {
  if (place.role < -1 || place.role > 1) return false;
  if (!place.known()) return true;
  return place.triangle < world.parts[place.role == 0 ? a : b].solid->mesh().triangles.size();
}

bool fits(const World& world, std::uint64_t key, const PairMemo& memo) {
  const std::uint64_t a = key >> 32, b = key & 0xffffffff;
  if (a >= b || b >= world.parts.size()) return false;
  const auto a_index = static_cast<std::uint32_t>(a), b_index = static_cast<std::uint32_t>(b);
  return !memo.held || fits(world, memo.held->place, a_index, b_index);
}

bool fits(const World& world, const SessionState& state) {
  const auto is_part = [&](std::uint32_t index) { return index < world.parts.size(); };
  const auto is_pair = [&](PartId a, PartId b) { return a < b && world.find(a) && world.find(b); };
  if (state.parts.size() != world.parts.size() || state.tick != world.tick) return false;
  for (const PartState& part : state.parts)
    if (!(part.growth_mm >= 0.0) || !(part.growth_mm < kLargestCoordinate_mm)) return false;
  for (const auto& [ids, clashes] : state.open) {
    if (!is_pair(ids.first, ids.second)) return false;
    for (const OpenClash& clash : clashes)
      if (clash.last.part_a != ids.first || clash.last.part_b != ids.second) return false;
  }
  return std::ranges::all_of(state.placed, is_part) && std::ranges::all_of(state.rehash, is_part) &&
         std::ranges::all_of(state.owed, [&](IndexPair p) { return p.a < p.b && is_part(p.b); }) &&
         std::ranges::is_sorted(state.owed) &&
         std::ranges::all_of(state.kept, [&](const KeptPush& push) {
           return is_part(push.part) && is_user(world, push.user) && valid(push.X_WP) &&
                  push.turn_rad.norm() <= kMaxRotationPerTick_rad;
         });
}

bool fits(const World& world) {
  for (const Part& part : world.parts) {
    if (!valid(part.X_WP) || !is_user(world, part.holder) || !is_user(world, part.asked_by))
      return false;
    for (const auto& done : part.history.done)
      if (!valid(done.X_WP_before)) return false;
    for (const auto& undone : part.history.undone)
      if (!valid(undone.X_WP_after) || !valid(undone.move.X_WP_before)) return false;
  }
  for (std::size_t i = 0; i < world.users.size(); ++i)
    if (world.users[i].id.value != i + 1) return false;
  return std::ranges::all_of(world.guides, [&](const Guide& guide) {
    return world.find(guide.constraint.held.part) && world.find(guide.constraint.other.part) &&
           std::fabs(guide.relation.distance_mm) <= kLargestCoordinate_mm;
  });
}

// Parts that came, meshes that parts took, and tolerances, in their order: what is stated of a part
// may speak of a face that only one of its meshes has.
Status say_again(World& world, const std::vector<Decision>& restated) {
  for (const Decision& decision : restated) {
    if (edits_scene(decision.kind)) {
      if (!restate_edit(world, decision))
        return fail(Code::kInvalidInput, "the mesh of an added or replaced part is missing");
    } else if (Status said = set_tolerance(world, decision); !said) {
      return said;
    }
  }
  return ok();
}

Status state_rules(World& world, const std::vector<PairStatement>& statements) {
  std::map<std::pair<PartId, PartId>, PairRule> rules;
  for (const PairStatement& statement : statements) {
    const auto found = world.pair_rules.find({statement.a, statement.b});
    PairRule rule = found == world.pair_rules.end() ? PairRule{} : found->second;
    rule.a = statement.a, rule.b = statement.b;
    if (!world.find(rule.a) || !world.find(rule.b) || !(rule.a < rule.b) ||
        statement.has_band_a != (rule.band_a != nullptr) ||
        statement.has_band_b != (rule.band_b != nullptr) || statement.fit != rule.fit)
      return fail(Code::kInvalidInput, "its rules of pairs are not those of the scene");
    rule.excluded = statement.excluded;
    rule.reason = statement.reason;
    rules[{rule.a, rule.b}] = std::move(rule);
  }
  world.pair_rules = std::move(rules);
  return ok();
}

}  // namespace

std::vector<std::byte> encode_state(const World& world) {
  MORTISE_CHECK(world.state != nullptr, "a world has a state once it was stepped");
  Writer out;
  put_frame(out, world);
  put_memos(out, Memos(world.state->memos.begin(), world.state->memos.end()));
  return out.take();
}

Status restore_state(World& world, std::span<const std::byte> bytes) {
  const auto bad = [](const std::string& why) { return fail(Code::kInvalidInput, why); };
  MORTISE_CHECK(world.state == nullptr, "a state is restored into a world as it was loaded");
  Reader in(bytes);
  // 1. What the scene does not say.
  std::vector<Decision> restated, standing;
  in(world.tick, world.policy, world.edits, restated);
  if (Status said = say_again(world, restated); !said) return said;
  if (in.count(0) != world.parts.size() || !in.ok()) return bad("it has another number of parts");
  for (Part& part : world.parts) in(part);
  std::vector<PairStatement> statements;
  bool evaluates = false;
  auto state = empty_state(world);
  in(world.users, standing, world.remarks, statements, world.guides, world.next_constraint,
     world.next_group, evaluates, *state);
  const std::size_t memos = in.count(0);
  for (std::size_t i = 0; i < memos && in.ok(); ++i) {
    std::uint64_t key = 0;
    PairMemo memo;
    in(key, memo);
    if (!fits(world, key, memo)) return bad("it speaks of parts that the scene does not have");
    state->memos.insert_or_assign(key, std::move(memo));
  }
  if (!in.at_end()) return bad("its bytes are not a state");
  if (!fits(world) || !fits(world, *state)) return bad("it does not fit the scene");
  // 2. Rules; what is judged anew for them is in the state already.
  if (Status said = state_rules(world, statements); !said) return said;
  if (world.evaluates != evaluates) return bad("its rules are not those of the scene");
  world.standing = std::move(standing);
  // 3. What follows from the rest.
  count_parts(world, *state);
  set_resting_boxes(world, *state);
  world.state = std::move(state);
  return ok();
}

// Blocks of memos that wait to be put into the copy, the copy itself, which only drafts touch, and
// memory that is used again: fetched anew, it would cost the tick more than the copying.
struct CheckpointMaker::Copies {
  using Block = std::vector<std::pair<std::uint64_t, PairMemo>>;  ///< of room for kBlock
  struct Numbered {
    std::uint64_t number;
    Block memos;
  };
  std::mutex mutex;
  std::deque<Numbered> waiting;
  std::uint64_t number = 0;  ///< of the last block
  Block open;                ///< being filled, by the tick
  std::vector<Block> spare;
  std::vector<std::byte> spare_frame;
  Memos memos;

  // Written to once, so that its pages are there.
  static Block fresh_block() {
    Block block(kBlock);
    block.clear();
    return block;
  }
  Block empty_block() {
    {
      const std::lock_guard lock(mutex);
      if (!spare.empty()) {
        Block block = std::move(spare.back());
        spare.pop_back();
        return block;
      }
    }
    return fresh_block();
  }
  std::size_t spare_room() {
    const std::lock_guard lock(mutex);
    return spare.size() * kBlock;
  }
  void add_spare() {
    Block block = fresh_block();
    const std::lock_guard lock(mutex);
    spare.push_back(std::move(block));
  }
  std::vector<std::byte> empty_frame() {
    const std::lock_guard lock(mutex);
    return std::move(spare_frame);
  }
  void close_block() {
    if (open.empty()) return;  // a block without room must not come back as a spare one
    const std::lock_guard lock(mutex);
    waiting.push_back({++number, std::exchange(open, {})});
  }
  void take_up_to(std::uint64_t last) {
    std::vector<Block> taken;
    {
      const std::lock_guard lock(mutex);
      for (; !waiting.empty() && waiting.front().number <= last; waiting.pop_front())
        taken.push_back(std::move(waiting.front().memos));
    }
    for (Block& block : taken) {
      for (auto& [key, memo] : block) memos.insert_or_assign(key, std::move(memo));
      block.clear();
    }
    const std::size_t most = memos.size() / kBlock + 2;
    const std::lock_guard lock(mutex);
    for (Block& block : taken)
      if (spare.size() < most) spare.push_back(std::move(block));
  }
  void give_back(std::vector<std::byte> frame) {
    const std::lock_guard lock(mutex);
    spare_frame = std::move(frame);
  }
};

CheckpointMaker::CheckpointMaker() : copies_(std::make_shared<Copies>()) {}
CheckpointMaker::~CheckpointMaker() = default;

void CheckpointMaker::begin(World& world) {
  copies_ = std::make_shared<Copies>();
  copies_->give_back(std::vector<std::byte>(kRoomOfPart * (world.parts.size() + 1)));
  running_ = false;
  if (!world.state) return;  // every memo is still to be made, and then is touched
  world.state->touched.clear();
  for (auto& [key, memo] : world.state->memos) {
    memo.touched = false;
    world.state->touch(key, memo);
  }
}

StateDraft CheckpointMaker::after_tick(World& world, bool due) {
  if (!running_ && !due) return {};
  SessionState& state = *world.state;
  if (!running_) {
    slices_left_ = kMostSlices;
    slice_ = std::max(kLeastSlice, 2 * state.touched.size() / kMostSlices);
    at_ = 0;
  }
  running_ = true;
  copy_settled(state);
  if (--slices_left_ > 0 && state.touched.size() > kLeastSlice) {
    if (copies_->spare_room() < state.touched.size()) copies_->add_spare();
    return {};
  }
  running_ = false;
  copy(state.touched);
  state.touched.clear();
  copies_->close_block();
  Writer frame(copies_->empty_frame());
  put_frame(frame, world);
  return [copies = copies_, last = copies_->number, bytes = frame.take()]() mutable {
    copies->take_up_to(last);
    Writer out;
    out.append(bytes);
    copies->give_back(std::move(bytes));
    put_memos(out, copies->memos);
    return out.take();
  };
}

void CheckpointMaker::copy_settled(SessionState& state) {
  std::vector<SessionState::Touched>& touched = state.touched;
  std::vector<SessionState::Touched>& settled = settled_;
  settled.clear();
  std::size_t looks = std::min(touched.size(), kLooks * slice_);
  for (std::size_t left = slice_; looks > 0 && left > 0; --looks) {
    if (at_ >= touched.size()) at_ = 0;
    if (touched[at_].memo->touched_tick == state.tick) {
      ++at_;
      continue;
    }
    settled.push_back(touched[at_]);
    touched[at_] = touched.back();
    touched.pop_back();
    --left;
  }
  copy(settled);
}

void CheckpointMaker::copy(std::span<const SessionState::Touched> some) {
  constexpr std::size_t kAhead = 8;  // memos: the time that memory takes to come
  Copies::Block& block = copies_->open;
  for (std::size_t i = 0; i < some.size(); ++i) {
    if (i + kAhead < some.size()) prefetch(*some[i + kAhead].memo);
    if (block.size() == kBlock) copies_->close_block();
    if (block.empty() && block.capacity() < kBlock) block = copies_->empty_block();
    some[i].memo->touched = false;
    block.emplace_back(some[i].key, *some[i].memo);
  }
}

}  // namespace mortise
