#include "server/uploads.h"

#include <algorithm>
#include <cstdio>

#include "common/session/world/part_shapes.h"
#include "common/session/world/rights.h"

namespace mortise {
namespace {

// Of a mesh, to the one that stands by, in a tick: 15 MB a second at 60 Hz.
constexpr std::uint64_t kTellAtOnce_bytes = 256 * 1024;

std::string in_MB(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MB", static_cast<double>(bytes) * 1e-6);
  return text;
}

std::string key_text(UserId user, std::uint64_t upload) {
  return std::to_string(user.value) + "/" + std::to_string(upload);
}

// As it came: a copy into one file would touch all of its memory in ticks. Small ones are put
// together, so that they take no more than they hold.
void keep(std::vector<std::byte> bytes, std::vector<std::vector<std::byte>>& pieces) {
  if (pieces.empty() || pieces.back().size() + bytes.size() > kUploadPiece_bytes)
    return pieces.push_back(std::move(bytes));
  pieces.back().insert(pieces.back().end(), bytes.begin(), bytes.end());
}

}  // namespace

void Uploads::note_follower(bool is_there, bool has_come) {
  has_follower_ = is_there;
  if (!has_come) return;
  told_.clear();
  for (Telling& telling : telling_) telling.told = 0;
}

// 1. pieces

void Uploads::receive(UploadPiece piece, World& world) {
  std::vector<std::byte> bytes = std::exchange(piece.bytes, {});
  const Key key{piece.user, piece.upload};
  if (piece.offset == 0 && begin(piece, world) == nullptr) return;
  const auto found = uploads_.find(key);
  // What is still under way of one that has ended says nothing new.
  if (found == uploads_.end() || !found->second.is_open()) return;
  Upload& upload = found->second;
  if (piece.offset != upload.received || piece.length != upload.head.length)
    return end(upload, Refusal::kUnreadableMesh,
               upload.head.name + ": its pieces do not follow each other");
  upload.tick_bytes += bytes.size();
  if (upload.tick_bytes > kUploadAhead_bytes)
    return end(upload, Refusal::kRateTooHigh,
               upload.head.name + ": was sent faster than the server confirms it");
  upload.received += bytes.size();
  keep(std::move(bytes), upload.pieces);
  upload.is_new = true;
  if (upload.received == upload.head.length) finish(key, upload, world);
}

Uploads::Upload* Uploads::begin(const UploadPiece& piece, const World& world) {
  const Key key{piece.user, piece.upload};
  const auto known = uploads_.find(key);
  if (known != uploads_.end() && known->second.is_open() &&
      known->second.received == known->second.head.length)
    return nullptr;               // it is being read
  if (known != uploads_.end()) {  // again from its beginning
    bytes_of_[piece.user] -= known->second.head.length;
    uploads_.erase(known);
  }
  Refusal refusal = Refusal::kNone;
  std::string text = why_not(piece, world, refusal);
  Upload& upload = uploads_[key];
  upload.head = piece;
  upload.state.user = piece.user;
  upload.state.upload = piece.upload;
  if (refusal != Refusal::kNone) {
    upload.head.length = 0;
    end(upload, refusal, std::move(text));
    return nullptr;
  }
  bytes_of_[piece.user] += piece.length;
  return &upload;
}

std::string Uploads::why_not(const UploadPiece& piece, const World& world, Refusal& refusal) const {
  const User* user = world.find(piece.user);
  if (user == nullptr || !may_change(world, *user, Right::kParts)) {
    refusal = Refusal::kNoRight;
    return "'" + (user != nullptr ? user->name : std::string()) +
           "' may not change parts in this scenario";
  }
  refusal = Refusal::kUploadLimit;
  if (!world.shapes) return "this session takes no parts";
  if (piece.length > limits_.upload_bytes)
    return piece.name + ": has " + in_MB(piece.length) + "; one upload has at most " +
           in_MB(limits_.upload_bytes);
  const auto sent = bytes_of_.find(piece.user);
  const std::uint64_t before = sent == bytes_of_.end() ? 0 : sent->second;
  if (before + piece.length > limits_.upload_bytes_of_user)
    return piece.name + ": has " + in_MB(piece.length) + ", and '" + user->name + "' has sent " +
           in_MB(before) + " already; a user sends at most " + in_MB(limits_.upload_bytes_of_user);
  const auto open = std::ranges::count_if(uploads_, [&](const auto& entry) {
    return entry.first.first == piece.user && entry.second.is_open();
  });
  if (open >= limits_.uploads_at_once)
    return piece.name + ": " + std::to_string(open) +
           " files of this user are under way already; send it after them";
  refusal = Refusal::kNone;
  return {};
}

void Uploads::end(Upload& upload, Refusal refusal, std::string text) {
  drop_file(upload);
  upload.state.refusal = refusal;
  upload.state.text = std::move(text);
  upload.is_new = true;
}

void Uploads::finish(const Key& key, Upload& upload, World& world) {
  PartMaker::Wish wish;
  wish.key = key_text(key.first, key.second);
  wish.name = upload.head.name;
  wish.hash = upload.head.hash;
  wish.unit_mm = upload.head.unit_mm;
  wish.pieces = std::move(upload.pieces);
  maker(world).make(std::move(wish));
}

void Uploads::drop(UserId user) {
  for (auto& [key, upload] : uploads_)
    if (key.first == user) drop_file(upload);
  std::erase_if(uploads_, [&](const auto& entry) { return entry.first.first == user; });
}

void Uploads::drop_file(Upload& upload) {
  auto file = std::make_shared<decltype(upload.pieces)>(std::exchange(upload.pieces, {}));
  if (maker_) maker_->discard(std::move(file));
}

void Uploads::note_used(const std::string& mesh_hash) {
  used_.insert(mesh_hash);
  if (auto unused = unused_.extract(mesh_hash); unused && maker_)
    maker_->discard(std::move(unused.mapped().bytes));
}

PartMaker& Uploads::maker(const World& world) {
  if (!maker_) {
    maker_ = std::make_unique<PartMaker>(world.shapes->make(), threads_, publish_);
    for (const Part& part : world.parts) used_.insert(part.solid->hash());
  }
  return *maker_;
}

// 2. what was made of them

void Uploads::settle(World& world, Intake& intake) {
  if (maker_)
    for (PartMaker::Made& made : maker_->take()) {
      take_made(made, world);
      maker_->discard(std::make_shared<PartMaker::Made>(std::move(made)));
    }
  for (auto& [key, upload] : uploads_) {
    upload.tick_bytes = 0;
    if (!upload.is_new) continue;
    upload.is_new = false;
    upload.state.received = upload.received;
    intake.uploads.push_back(upload.state);
  }
}

void Uploads::take_made(PartMaker::Made& made, World& world) {
  making_.erase(made.key);
  if (made.as) {
    if (made.shape)
      world.shapes->add(made.shape, *made.as);
    else
      failed_[made.key] = std::move(made.text);
    return;
  }
  if (made.shape) {
    const std::string hash = made.shape->solid->hash();
    world.shapes->add(made.shape, made.quantum_mm);
    if (made.recognized) world.recognized.try_emplace(hash, made.recognized);
    if (made.mesh_bytes && !used_.contains(hash))
      unused_.try_emplace(hash, Telling{hash, made.quantum_mm, made.mesh_bytes, 0});
  }
  for (auto& [key, upload] : uploads_) {
    if (key_text(key.first, key.second) != made.key) continue;
    if (!made.shape) return end(upload, Refusal::kUnreadableMesh, std::move(made.text));
    upload.state.ready = true;
    upload.state.mesh_hash = made.shape->solid->hash();
    upload.state.text = made.text;
    upload.is_new = true;
    return;
  }
}

Uploads::Mesh Uploads::find(UserId user, const std::string& name, World& world) {
  Mesh mesh{Mesh::Is::kUnknown, name, ""};
  if (!world.shapes) return mesh;
  for (const auto& [key, upload] : uploads_) {  // the last one counts
    if (key.first != user || upload.head.hash != name) continue;
    const UploadState& state = upload.state;
    mesh = {Mesh::Is::kComing, state.mesh_hash, state.text};
    if (state.refusal != Refusal::kNone) mesh.is = Mesh::Is::kUnusable;
    if (state.ready) mesh.is = Mesh::Is::kHere;
  }
  if (mesh.is == Mesh::Is::kUnknown) {
    const PartShapes::Mesh known = world.shapes->find(name);
    if (!known.solid) return mesh;
    mesh = {Mesh::Is::kHere, name, ""};
    if (!world.shapes->is_made(name, known.quantum_mm)) {
      mesh.is = Mesh::Is::kComing;
      PartMaker::Wish wish;
      wish.key = name;
      wish.solid = known.solid;
      wish.quantum_mm = known.quantum_mm;
      PartMaker& by = maker(world);
      if (making_.insert(name).second) by.make(std::move(wish));
    }
  }
  if (mesh.is == Mesh::Is::kHere && !is_told(mesh.hash)) mesh.is = Mesh::Is::kComing;
  return mesh;
}

Uploads::Mesh Uploads::find(const std::string& mesh_hash, const PartShapes::AsPart& as,
                            World& world) {
  const PartShapes::Mesh known = world.shapes->find(mesh_hash);
  if (!known.solid) return {Mesh::Is::kUnknown, mesh_hash, ""};
  if (world.shapes->is_made(mesh_hash, as)) return {Mesh::Is::kHere, mesh_hash, ""};
  PartMaker::Wish wish;
  wish.key = mesh_hash + "/" + std::to_string(as.part.value) + "/" + std::to_string(as.said);
  wish.solid = known.solid;
  wish.quantum_mm = known.quantum_mm;
  wish.as = as;
  if (const auto failed = failed_.find(wish.key); failed != failed_.end())
    return {Mesh::Is::kUnusable, mesh_hash, failed->second};
  if (making_.insert(wish.key).second) maker(world).make(std::move(wish));
  return {Mesh::Is::kComing, mesh_hash, ""};
}

// 3. the one that stands by

bool Uploads::is_told(const std::string& mesh_hash) {
  if (!has_follower_ || used_.contains(mesh_hash) || told_.contains(mesh_hash)) return true;
  const auto unused = unused_.find(mesh_hash);
  if (unused == unused_.end()) return true;
  const bool is_on_its_way = std::ranges::any_of(
      telling_, [&](const Telling& telling) { return telling.hash == mesh_hash; });
  if (!is_on_its_way) telling_.push_back(unused->second);
  return false;
}

std::optional<MeshPiece> Uploads::next_piece() {
  if (telling_.empty()) return std::nullopt;
  Telling& telling = telling_.front();
  MeshPiece piece;
  piece.hash = telling.hash;
  piece.quantum_mm = telling.quantum_mm;
  piece.length = telling.bytes->size();
  piece.offset = telling.told;
  const std::uint64_t size = std::min(kTellAtOnce_bytes, piece.length - piece.offset);
  const auto from = telling.bytes->begin() + static_cast<std::ptrdiff_t>(piece.offset);
  piece.bytes.assign(from, from + static_cast<std::ptrdiff_t>(size));
  telling.told += size;
  if (telling.told == piece.length) {
    told_.insert(telling.hash);
    telling_.pop_front();
  }
  return piece;
}

}  // namespace mortise
