// Who comes to the gateway uninvited, broken or slow: over real sockets, with a real session behind
// it.
#include "tests/network/gateway_fixture.h"

namespace mortise::test {
namespace {

TEST_F(GatewayFixture, StrangersAreTurnedAwayAtTheDoor) {
  serve();
  GoodPages good(*this);
  const auto status_of = [&](auto change) {
    PageClientOptions page = designer();
    change(page);
    return PageClient(page).status();
  };
  EXPECT_EQ(status_of([](auto&) {}), 101);
  EXPECT_EQ(status_of([](auto& page) { page.token = std::string(32, '0'); }), 401);
  EXPECT_EQ(status_of([](auto& page) { page.token = ""; }), 401);
  EXPECT_EQ(status_of([](auto& page) { page.protocols = "mortise.9"; }), 400);
  EXPECT_EQ(status_of([](auto& page) { page.origin = "http://evil.example"; }), 403);
  EXPECT_EQ(status_of([](auto& page) { page.origin = "null"; }), 403);
  EXPECT_EQ(status_of([](auto& page) { page.origin = "none"; }), 403);
  EXPECT_EQ(status_of([](auto& page) { page.host = "evil.example"; }), 421);
  EXPECT_EQ(http_request(port, "/", {{"Host", "evil.example"}}).status, 421);
  EXPECT_EQ(http_request(port, "/statistics").status, 401);
  EXPECT_EQ(http_request(port, "/mesh/0.bin", {{"Authorization", "Bearer x"}}).status, 401);
  EXPECT_EQ(incidents("wrong_token"), 4);
  EXPECT_EQ(incidents("wrong_origin"), 3);
  EXPECT_EQ(incidents("wrong_host"), 2);
  EXPECT_GE(lines, 3);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, ARequestNamesOneHost) {
  serve();
  const std::string host = "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  const auto first_line = [&](const std::string& hosts) {
    RawConnection raw(port);
    raw.send("GET / HTTP/1.1\r\n" + hosts + "Connection: close\r\n\r\n");
    bool closed = false;
    const std::string text = raw.read(10.0, closed);
    return text.substr(0, text.find("\r\n"));
  };
  EXPECT_EQ(first_line(host), "HTTP/1.1 200 OK");
  EXPECT_EQ(first_line(host + "Host: evil.example\r\n"), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(first_line("host: evil.example\r\n" + host), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(first_line(host + host), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(first_line(""), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(incidents("bad_request"), 4);
}

TEST_F(GatewayFixture, BadMessagesCloseTheirPageOnly) {
  serve();
  GoodPages good(*this);
  const auto closed_with = [&](auto misbehave) {
    PageClient bad(designer());
    EXPECT_EQ(bad.status(), 101);
    misbehave(bad);
    EXPECT_TRUE(bad.wait([&] { return !bad.is_open(); }));
    return bad.close_code();
  };
  EXPECT_EQ(closed_with([](PageClient& bad) { bad.send(std::string(20000, 'x')); }), 1009);
  EXPECT_EQ(closed_with([](PageClient& bad) {
              for (int i = 0; i < 12; ++i) bad.send("{\"type\":");
              EXPECT_NE(bad.await("error")["text"].get<std::string>().find("not JSON"),
                        std::string::npos);
            }),
            1008);
  EXPECT_EQ(closed_with([](PageClient& bad) {
              for (int i = 0; i < 12; ++i) bad.send_binary("MPF1");
            }),
            1008);
  EXPECT_EQ(closed_with([](PageClient& bad) {
              for (int i = 0; i < 2000; ++i) bad.send(R"({"type":"ping","at":1})");
            }),
            1008);
  EXPECT_EQ(incidents("oversized"), 1);
  EXPECT_GE(incidents("malformed"), 12);
  EXPECT_EQ(incidents("flood"), 1);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, AFewMistakesAreForgiven) {
  serve();
  PageClient ann(designer());
  for (int i = 0; i < 4; ++i) ann.send("mistake");
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ann.await("error").is_object());
  EXPECT_TRUE(ann.join("ann"));
}

TEST_F(GatewayFixture, SlowAndSilentConnectionsKeepNobodyOut) {
  options.limits.connections = 20;
  serve();
  GoodPages good(*this);
  std::vector<std::unique_ptr<RawConnection>> lorises;
  for (int i = 0; i < 60; ++i) {
    lorises.push_back(std::make_unique<RawConnection>(port));
    lorises.back()->send("GET / HTTP/1.1\r\nHost: 127.");
    if (i % 10 == 0) good.expect_to_go_on();
  }
  EXPECT_EQ(http_request(port, "/").status, 200);
  EXPECT_GE(incidents("too_many_connections"), 30);
  for (const auto& loris : lorises) {
    bool closed = false;
    loris->read(4.0, closed);
    EXPECT_TRUE(closed);
  }
  EXPECT_GE(incidents("slow_request"), 1);
  bool closed = false;
  RawConnection garbage(port);
  garbage.send("\x16\x03\x01 this is no HTTP\r\n\r\n");
  EXPECT_NE(garbage.read(4.0, closed).find("400"), std::string::npos);
  EXPECT_TRUE(closed);
  RawConnection large(port);
  large.send("GET / HTTP/1.1\r\nX: " + std::string(10000, 'x') + "\r\n\r\n");
  large.read(4.0, closed);
  EXPECT_TRUE(closed);
  EXPECT_GE(incidents("bad_request"), 2);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, WhoAnswersNoPingIsClosedAndItsPartFree) {
  options.limits.silent_s = 1.0;
  serve();
  PageClient ann(designer()), bob(designer());
  ASSERT_TRUE(ann.join("ann") && bob.join("bob"));
  ASSERT_TRUE(ann.command({{"do", "grab"}, {"part", kBlock}}));
  // From here on Ann's browser is gone, though its connection stands.
  ASSERT_TRUE(bob.wait([&] { return bob.seen.contains(kBlock) && bob.seen[kBlock].holder; }));
  EXPECT_TRUE(bob.wait([&] { return !bob.seen[kBlock].holder; }, 6.0));
  EXPECT_EQ(incidents("silent"), 1);
}

TEST_F(GatewayFixture, TlsForThoseWhoWantIt) {
  options.certificate = folder / "certificate.pem";
  options.key = folder / "key.pem";
  ASSERT_TRUE(write_certificate(options.certificate, options.key));
  serve();
  EXPECT_EQ(gateway->address(tokens.designer).substr(0, 8), "https://");
  const HttpAnswer page = http_request(port, "/", {}, "GET", true);
  EXPECT_EQ(page.status, 200);
  EXPECT_NE(page.field("Content-Security-Policy").find("wss://"), std::string::npos);
  GoodPages good(*this);
  good.expect_to_go_on();
  PageClientOptions plain = designer();
  plain.tls = false;
  EXPECT_NE(PageClient(plain).status(), 101);
  EXPECT_GE(incidents("tls"), 1);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, WhatCannotBeServedIsSaidAtTheStart) {
  client = std::make_unique<Client>(*channel);
  feed = std::make_unique<web::LiveFeed>(*client, options.limits);
  const auto why = [&] {
    auto page = web::PageFiles::open(folder / "page");
    auto opened = web::Gateway::open(options, tokens, *page, *feed, [](const std::string&) {});
    return opened ? std::string() : opened.error().text;
  };
  options.address = "192.0.2.1";
  EXPECT_NE(why().find("cannot listen"), std::string::npos);
  options.address = "nonsense";
  EXPECT_NE(why().find("cannot read the address"), std::string::npos);
  options.address = "127.0.0.1";
  options.certificate = folder / "page/index.html";
  options.key = options.certificate;
  EXPECT_NE(why().find("no certificate"), std::string::npos);
}

TEST_F(GatewayFixture, TooManyBrowsersAndTheEnd) {
  options.limits.browsers = 3;
  serve();
  GoodPages good(*this);
  PageClient third(designer());
  EXPECT_EQ(third.status(), 101);
  EXPECT_EQ(PageClient(designer()).status(), 503);
  third.drop();
  EXPECT_TRUE(good.bob.wait([&] { return PageClient(designer()).status() == 101; }));
  gateway->stop();
  EXPECT_TRUE(good.ann.wait([&] { return !good.ann.is_open(); }));
  EXPECT_TRUE(good.bob.wait([&] { return !good.bob.is_open(); }));
  EXPECT_EQ(good.ann.close_code(), 1001);
  EXPECT_EQ(good.bob.close_code(), 1001);
}

}  // namespace
}  // namespace mortise::test
