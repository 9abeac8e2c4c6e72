#include "tests/bench/web_load.h"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <regex>

namespace mortise::bench {
namespace {

constexpr double kStart_s = 10.0;
constexpr double kShake_mm = 0.02;
constexpr double kPoll_s = 0.002;

}  // namespace

ThreadTime first_thread_of(pid_t process) {
  const std::string id = std::to_string(process);
  std::ifstream books("/proc/" + id + "/task/" + id + "/schedstat");
  double ran_ns = 0.0, waited_ns = 0.0;
  if (!(books >> ran_ns >> waited_ns)) return {NAN, NAN};
  return {ran_ns * 1e-9, waited_ns * 1e-9};
}

BenchGateway::BenchGateway(BenchServer& server) {
  const std::string page = server.folder().write("index.html", "<!doctype html>");
  program_ = std::make_unique<test::Program>(
      server.folder().path(), "mortise-web",
      std::vector<std::string>{"--domain", std::to_string(server.domain()), "--page",
                               server.folder().path().string(), "--addresses", "-", "--quiet"});
  const std::regex line("designer http://[^:]*:(\\d+)/#token=(\\S+)\\n");
  std::smatch match;
  for (const double end_s = steady_s() + kStart_s; steady_s() < end_s; sleep_s(0.05)) {
    const std::string out = program_->out();
    if (!std::regex_search(out, match, line)) continue;
    port_ = std::stoi(match[1]);
    token_ = match[2];
    return;
  }
}

double BenchGateway::resident_mb() const {
  std::ifstream statm("/proc/" + std::to_string(program_->pid()) + "/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

Json BenchGateway::statistics() const {
  return Json::parse(
      test::http_request(port_, "/statistics", {{"Authorization", "Bearer " + token_}}).body,
      nullptr, false);
}

PageLoad::PageLoad(const BenchGateway& gateway, const Shape& shape) : shape_(shape) {
  test::PageClientOptions options;
  options.port = gateway.port();
  options.token = gateway.token();
  for (int i = 0; i < shape.pages + shape.stopped; ++i) {
    Page page;
    if (i >= shape.pages) options.receive_buffer_bytes = 4096;
    page.client = std::make_unique<test::PageClient>(options);
    const Json scene = page.client->await("scene");
    if (scene.is_null() || !page.client->join("page" + std::to_string(i + 1))) {
      why_not_ = "page " + std::to_string(i + 1) + " did not get in";
      return;
    }
    if (shape.moves && i < shape.pages) {
      int number = 0;
      for (const Json& part : scene["parts"])
        if (part["moving"].get<bool>() && number++ == shape.first_part + i)
          page.part = part["id"].get<std::uint32_t>();
      if (page.part == 0 || !page.client->command({{"do", "grab"}, {"part", page.part}})) {
        why_not_ = "page " + std::to_string(i + 1) + " got no part";
        return;
      }
    }
    page.client->keeps_texts = false;
    (i < shape.pages ? pages_ : stopped_).push_back(std::move(page));
  }
  joined_ = true;
  thread_ = std::thread([this] { run(); });
}

PageLoad::~PageLoad() { stop(); }

void PageLoad::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void PageLoad::beat(Page& page, bool first) {
  ++page.beats;
  if (shape_.moves) {
    const double step_mm = page.beats % 2 == 0 ? kShake_mm : -kShake_mm;
    page.client->move(page.part, first ? 0.5 * step_mm : step_mm, 0.0, 0.0);
  } else {
    page.client->send(R"({"type":"view","p":[1,2,3],"target":[0,0,0],"up":[0,0,1]})");
  }
}

void PageLoad::run() {
  const double start_s = steady_s();
  double next_s = start_s;
  bool counts = false, first = true;
  while (!stop_) {
    if (marked_ && !counts) {
      counts = true;
      for (Page& page : pages_) {
        page.frames_before = page.client->frames;
        page.bytes_before = page.client->frame_bytes;
      }
    }
    const double now_s = steady_s();
    if (now_s >= next_s) {
      for (Page& page : pages_) beat(page, first);
      first = false;
      next_s = std::max(next_s + 1.0 / shape_.rate_hz, now_s);
    }
    for (Page& page : pages_) page.client->run(0.0);
    if (now_s - start_s < shape_.stop_at_s)
      for (Page& page : stopped_) page.client->run(0.0);
    sleep_s(kPoll_s);
  }
}

std::vector<PageLoad::Seen> PageLoad::seen() const {
  std::vector<Seen> all;
  for (const Page& page : pages_) {
    all.push_back({page.client->frames - page.frames_before,
                   page.client->frame_bytes - page.bytes_before, page.client->is_open()});
  }
  return all;
}

}  // namespace mortise::bench
