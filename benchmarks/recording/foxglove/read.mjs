// Reads every message of recordings with @mcap/core and Foxglove's decoder: node read.mjs FILE…
import { readFile } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";

for (const file of process.argv.slice(2)) {
  const content = await readFile(file);
  const readable = {
    size: async () => BigInt(content.length),
    read: async (offset, length) => new Uint8Array(content.subarray(Number(offset), Number(offset + length))),
  };
  const decompressHandlers = { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoders = new Map();
  const counts = new Map();
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    if (!decoders.has(channel.id)) {
      const schema = reader.schemasById.get(channel.schemaId);
      decoders.set(channel.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
    }
    decoders.get(channel.id).readMessage(message.data);
    counts.set(channel.topic, (counts.get(channel.topic) ?? 0) + 1);
  }
  const total = [...counts.values()].reduce((sum, count) => sum + count, 0);
  const expected = Number(reader.statistics.messageCount);
  console.log(`${file}: ${total} of ${expected} messages in ${counts.size} topics`);
  if (total !== expected) process.exit(1);
}
