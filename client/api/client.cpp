#include <mortise/client.h>

#include <algorithm>
#include <chrono>

#include "client/api/convert.h"
#include "client/client.h"
#include "common/messages/names.h"
#include "idl/dds_channel.h"

namespace mortise::api {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kAnswer_s = 5.0;  // for the answer to a request
// The longest wait that a caller may ask for: beyond it the sum with the clock could overflow.
constexpr double kLongest_s = 3600.0;

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(std::clamp(seconds, 0.0, kLongest_s)));
}

mortise::DdsOptions dds_of(const ClientOptions& options) {
  mortise::DdsOptions dds;
  dds.session = options.session;
  dds.domain = options.domain;
  dds.interface = options.interface;
  dds.server = options.server;
  dds.discovery_server = options.discovery_server;
  dds.discovery_port = options.discovery_port;
  dds.keys = options.keys;
  dds.meshes = false;
  dds.features = false;
  return dds;
}

}  // namespace

struct Client::Impl {
  // The channel outlives the client.
  std::unique_ptr<mortise::ClientChannel> channel;
  mortise::Client client;
  mortise::LocalUser user = 0;
  Heard heard;  // since the last listen()
  std::vector<mortise::Reply> replies;

  explicit Impl(std::unique_ptr<mortise::ClientChannel> opened)
      : channel(std::move(opened)), client(*channel) {}

  std::string part_name(mortise::PartId id) const {
    const auto part = client.parts().find(id);
    return part != client.parts().end() ? part->second.info.name : std::string();
  }
  std::string user_name(mortise::UserId id) const {
    for (const mortise::UserInfo& known : client.users())
      if (known.user == id) return known.name;
    return {};
  }
  Clash clash(const mortise::ClashEvent& event) const {
    Clash out = clash_of(event.verdict, {part_name(event.part_a), part_name(event.part_b),
                                         part_name(event.verdict.separation_blocker)});
    out.id = event.clash.value;
    return out;
  }

  void poll() {
    const mortise::ClientUpdate update = client.poll();
    for (const mortise::ClashEvent& event : update.events)
      heard.events.push_back({std::string(mortise::name_of(event.kind)), event.tick,
                              user_name(event.user), clash(event)});
    for (const mortise::RefusedIncrement& refused : update.refused)
      heard.refused.push_back("move of " + part_name(refused.part) + ": " +
                              std::string(mortise::name_of(refused.reason)));
    heard.server_lost |= update.server_lost;
    replies.insert(replies.end(), update.replies.begin(), update.replies.end());
  }

  template <class Until>
  bool wait(double seconds, Until until) {
    for (const Clock::time_point end = after(seconds);;) {
      poll();
      if (until()) return true;
      const double left_s = std::chrono::duration<double>(end - Clock::now()).count();
      if (left_s <= 0.0) return false;
      client.await_news(left_s);
    }
  }

  Status answer_to(std::uint64_t seq, const std::string& what) {
    if (seq == 0) return Error{Code::kRuntime, what + ": not joined"};
    const mortise::Reply* found = nullptr;
    const std::uint64_t losses = client.statistics().server_losses;
    const auto has_come = [&] {
      for (const mortise::Reply& reply : replies)
        if (reply.seq == seq && reply.user == client.user_id(user)) found = &reply;
      return found != nullptr || client.statistics().server_losses != losses;
    };
    if (!wait(kAnswer_s, has_come)) return Error{Code::kLimit, what + ": the server is silent"};
    if (found == nullptr)
      return Error{Code::kRuntime,
                   what + ": the server went away before it answered; see whether it was done"};
    const Status status =
        found->refusal == mortise::Refusal::kNone
            ? Status()
            : Status(Error{Code::kInvalidInput,
                           what + ": " +
                               (found->text.empty() ? std::string(mortise::name_of(found->refusal))
                                                    : found->text)});
    replies.clear();
    return status;
  }
};

Result<Client> Client::join(const std::string& user, const ClientOptions& options) {
  auto channel = mortise::open_client_channel(dds_of(options));
  if (!channel) return error_of(channel.error());
  auto impl = std::make_unique<Impl>(std::move(*channel));
  impl->user = impl->client.add_user(user, options.role);
  const bool done = impl->wait(options.wait_s, [&] {
    const mortise::JoinState state = impl->client.join_state(impl->user);
    return state == mortise::JoinState::kRefused ||
           (state == mortise::JoinState::kJoined && impl->client.synced());
  });
  if (impl->client.join_state(impl->user) == mortise::JoinState::kRefused)
    return Error{Code::kInvalidInput, impl->client.refusal_text(impl->user)};
  if (!done)
    return Error{Code::kNotFound, "no server of session '" + options.session + "' at " +
                                      mortise::looked_at(dds_of(options)) + " in domain " +
                                      std::to_string(options.domain)};
  return Client(std::move(impl));
}

Client::Client(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() {
  if (impl_) impl_->client.leave(impl_->user);
}

std::vector<LivePart> Client::parts() const {
  std::vector<LivePart> parts;
  for (const auto& [id, known] : impl_->client.parts())
    parts.push_back({known.info.name, pose_of(known.info.X_WP), known.info.moving,
                     impl_->user_name(known.info.holder)});
  return parts;
}

std::vector<Clash> Client::open_clashes() const {
  std::vector<Clash> clashes;
  for (const auto& [id, event] : impl_->client.open_clashes())
    clashes.push_back(impl_->clash(event));
  std::stable_sort(clashes.begin(), clashes.end(), [](const Clash& x, const Clash& y) {
    return x.collision_class > y.collision_class;
  });
  return clashes;
}

Status Client::grab(const std::string& part) {
  const mortise::PartId id = impl_->client.find_part(part);
  if (!id) return Error{Code::kNotFound, "the session has no part '" + part + "'"};
  return impl_->answer_to(impl_->client.grab(impl_->user, id), "grab of '" + part + "'");
}

Status Client::release(const std::string& part) {
  const mortise::PartId id = impl_->client.find_part(part);
  if (!id) return Error{Code::kNotFound, "the session has no part '" + part + "'"};
  return impl_->answer_to(impl_->client.release(impl_->user, id), "release of '" + part + "'");
}

Status Client::move(const std::string& part, const Pose& dX_W) {
  const mortise::PartId id = impl_->client.find_part(part);
  const auto dX = pose_in(dX_W);
  if (!id) return Error{Code::kNotFound, "the session has no part '" + part + "'"};
  if (!dX) return Error{Code::kInvalidInput, "dX_W is no finite rigid motion"};
  const mortise::PartInfo& info = impl_->client.parts().at(id).info;
  const PushInPlace push = push_about(*dX, info.X_WP * info.reference_P);
  if (impl_->client.send(impl_->user, id, push.translation_mm, push.rotation_rad) == 0)
    return Error{Code::kRuntime, "move of '" + part + "': not joined"};
  impl_->poll();
  return {};
}

Heard Client::listen(double seconds) {
  impl_->wait(seconds, [] { return false; });
  return std::exchange(impl_->heard, {});
}

bool Client::server_present() const { return impl_->client.server_present(); }

}  // namespace mortise::api
