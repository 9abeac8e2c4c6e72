#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "client/client.h"
#include "common/io/scenario/scene_load.h"
#include "idl/dds_channel.h"
#include "server/tick_loop.h"

namespace mortise::test {

/// A session of the real tick loop in this process, over real DDS; turned by the test.
struct Site {
  Site(const DdsOptions& where, const std::string& yaml) : options(where) {
    auto reading = read_scenario_text(yaml, "site.yaml");
    if (!reading) throw std::runtime_error(reading.error().text);
    auto loaded = load_scene(reading->scenario, default_meshes());
    if (!loaded) throw std::runtime_error(loaded.error().text);
    scene = std::move(*loaded);
    auto opened = open_server_channel(options);
    if (!opened) throw std::runtime_error(opened.error().text);
    channel = std::move(*opened);
    TickLoopOptions loop_options;
    loop_options.session = options.session;
    loop = std::make_unique<TickLoop>(scene.world, *channel, clock, nullptr, loop_options);
    loop->open();
  }

  DdsOptions options;
  LoadedScene scene;
  std::unique_ptr<ServerChannel> channel;
  SystemClock clock;
  std::unique_ptr<TickLoop> loop;
};

/// One participant and all that it was told.
struct Person {
  /// What stands between a client and its channel.
  using Through = std::function<std::unique_ptr<ClientChannel>(std::unique_ptr<ClientChannel>)>;
  void enter(const DdsOptions& options, const std::string& name,
             const std::string& role = "designer", const Through& through = {}) {
    auto opened = open_client_channel(options);
    ASSERT_TRUE(opened) << opened.error().text;
    channel = through ? through(std::move(*opened)) : std::move(*opened);
    client = std::make_unique<Client>(*channel);
    client->add_user(name, role);
  }
  bool is_in() const { return client->join_state(0) == JoinState::kJoined && client->synced(); }
  void listen() {
    if (!client) return;
    const ClientUpdate update = client->poll();
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(replies, update.replies);
    append(refused, update.refused);
    append(decisions, update.decisions);
    append(events, update.events);
  }

  std::unique_ptr<ClientChannel> channel;
  std::unique_ptr<Client> client;
  std::vector<Reply> replies;
  std::vector<RefusedIncrement> refused;
  std::vector<Decision> decisions;
  std::vector<ClashEvent> events;

  bool was_decided(Decision::Kind kind) const {
    return std::any_of(decisions.begin(), decisions.end(),
                       [kind](const Decision& decision) { return decision.kind == kind; });
  }
  /// The answer to a command, none when it has not come.
  const Reply* answer(std::uint64_t seq) const {
    for (const Reply& reply : replies)
      if (reply.seq == seq) return &reply;
    return nullptr;
  }
};

}  // namespace mortise::test
