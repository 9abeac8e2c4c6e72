#!/usr/bin/env bash
# A test engineer with bots: a session under load, with limits that a job of CI can fail on.
./mortise server scenarios/gearbox.yaml --session load --domain $DOMAIN --log load.mcap --quiet >server.txt 2>&1 &
server=$!
trap 'kill -INT $server 2>/dev/null || true' EXIT
run ./mortise bot --session load --domain $DOMAIN --users 8 --rate 60 --seconds 10 --behaviour mixed --seed 1 --wait 60 \
  --limit lost_events=0 --limit unanswered=0 --junit bots.xml
saw 'p99'
saw 'lost_events' bots.xml
wanted=5 run ./mortise bot --session load --domain $DOMAIN --users 2 --seconds 2 --limit max_ms=0
saw 'above the limit' errors
kill -INT $server
wait $server
trap - EXIT
run ./mortise replay verify load.mcap
saw 'verified: .*bit for bit'
