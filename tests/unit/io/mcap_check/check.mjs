// Reads a session log with the independent reader @mcap/core, both front to back and by the index at its end, and
// prints one JSON document of what it found. Exit 1 when either way fails or the two disagree.
import {open, readFile} from "node:fs/promises";
import {McapIndexedReader, McapStreamReader} from "@mcap/core";
import * as fzstd from "fzstd";

const file = process.argv[2];
const decompressHandlers = {zstd: (data, size) => fzstd.decompress(data, new Uint8Array(Number(size)))};
const found = {records: {}, topics: {}, attachments: {}, metadata: {}, clashes: [], statistics: null};
const count = (table, key) => (table[key] = (table[key] ?? 0) + 1);

const stream = new McapStreamReader({decompressHandlers, validateCrcs: true, includeChunks: true});
stream.append(await readFile(file));
const topicOf = new Map();
for (let record; (record = stream.nextRecord()) != undefined; ) {
  count(found.records, record.type);
  if (record.type === "Channel") topicOf.set(record.id, record);
  if (record.type === "Attachment") found.attachments[record.name] = record.data.byteLength;
  if (record.type === "Metadata") found.metadata[record.name] = Object.fromEntries(record.metadata);
  if (record.type === "Statistics") found.statistics = {messages: Number(record.messageCount), chunks: record.chunkCount};
  if (record.type !== "Message") continue;
  const channel = topicOf.get(record.channelId);
  count(found.topics, channel.topic);
  if (channel.messageEncoding !== "json") continue;
  const value = JSON.parse(new TextDecoder("utf-8", {fatal: true}).decode(record.data));
  if (channel.topic === "/clashes") found.clashes.push(value);
}
found.done = stream.done();

const handle = await open(file);
const readable = {
  size: async () => BigInt((await handle.stat()).size),
  read: async (offset, size) => {
    const buffer = new Uint8Array(Number(size));
    await handle.read(buffer, 0, Number(size), Number(offset));
    return buffer;
  },
};
const indexed = await McapIndexedReader.Initialize({readable, decompressHandlers});
const byIndex = {};
for await (const message of indexed.readMessages()) count(byIndex, indexed.channelsById.get(message.channelId).topic);
found.schemas = [...indexed.schemasById.values()].map((s) => ({
  name: s.name, encoding: s.encoding, schema: s.encoding === "jsonschema" ? JSON.parse(new TextDecoder().decode(s.data)) : null,
}));
let attachmentsByIndex = 0;
for await (const attachment of indexed.readAttachments({validateCrcs: true})) attachmentsByIndex += attachment.data.length > 0;
let metadataByIndex = 0;
for await (const metadata of indexed.readMetadata()) metadataByIndex += metadata.metadata.size > 0;
await handle.close();

const same = Object.keys(found.topics).length === Object.keys(byIndex).length &&
  Object.entries(found.topics).every(([topic, n]) => byIndex[topic] === n) &&
  attachmentsByIndex === found.records.Attachment && metadataByIndex === found.records.Metadata;
found.index_agrees = same;
console.log(JSON.stringify(found));
process.exitCode = same && found.done ? 0 : 1;  // exit() would cut off what the pipe has not taken yet
