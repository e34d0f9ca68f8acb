// Reads an MCAP file with the reference reader, by its index and from front to back, and prints what it found as
// JSON: node check.cjs FILE. Fails when the file is not whole, a checksum is wrong or a message does not fit.
const { open } = require("node:fs/promises");
const { readFileSync } = require("node:fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const fzstd = require("fzstd");

const decompressHandlers = { zstd: (bytes, size) => fzstd.decompress(bytes, new Uint8Array(Number(size))) };

class File {
  constructor(handle) {
    this.handle = handle;
  }
  async size() {
    return BigInt((await this.handle.stat()).size);
  }
  async read(offset, length) {
    const buffer = new Uint8Array(Number(length));
    const { bytesRead } = await this.handle.read(buffer, 0, buffer.length, Number(offset));
    if (bytesRead !== buffer.length) throw new Error(`the file ends within ${length} bytes at ${offset}`);
    return buffer;
  }
}

// Every key of a message has to be in its schema, all the way down.
function checkAgainst(schema, value, path) {
  if (schema.type === "object") {
    for (const [key, part] of Object.entries(value)) {
      if (!(key in schema.properties)) throw new Error(`${path}.${key} is not in the schema`);
      checkAgainst(schema.properties[key], part, `${path}.${key}`);
    }
  } else if (schema.type === "array") {
    if (!Array.isArray(value)) throw new Error(`${path} is no list`);
    value.forEach((part) => checkAgainst(schema.items, part, path));
  } else if (typeof value !== (schema.type === "integer" ? "number" : schema.type)) {
    throw new Error(`${path} is no ${schema.type}`);
  }
}

function pointsOf(message) {
  const bytes = Buffer.from(message.data, "base64");
  if (bytes.length % message.point_stride !== 0) throw new Error("a cloud is not a whole number of points");
  return bytes.length / message.point_stride;
}

async function readByIndex(path) {
  const handle = await open(path);
  const reader = await McapIndexedReader.Initialize({ readable: new File(handle), decompressHandlers });
  const topics = {};
  const firstCloud = {};
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    const content = JSON.parse(Buffer.from(message.data).toString());
    checkAgainst(JSON.parse(Buffer.from(schema.data).toString()), content, schema.name);
    const topic = (topics[channel.topic] ??= { schema: schema.name, messages: 0, points: 0, boxes: 0 });
    topic.messages += 1;
    if (schema.name === "foxglove.PointCloud") {
      topic.points += pointsOf(content);
      firstCloud[channel.topic] ??= Array.from({ length: 3 }, (_, i) =>
        Buffer.from(content.data, "base64").readFloatLE(4 * i),
      );
    }
    if (schema.name === "foxglove.SceneUpdate") topic.boxes += content.entities.length;
  }
  await handle.close();
  const { messageCount, chunkCount, messageStartTime, messageEndTime } = reader.statistics;
  return {
    topics,
    firstCloud,
    messages: Number(messageCount),
    chunks: chunkCount,
    start_ns: messageStartTime.toString(),
    end_ns: messageEndTime.toString(),
  };
}

function countFromFrontToBack(path) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(readFileSync(path));
  let messages = 0;
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Message") messages += 1;
  }
  if (!reader.done()) throw new Error("the file has no end");
  return messages;
}

async function main(path) {
  const found = await readByIndex(path);
  const streamed = countFromFrontToBack(path);
  if (streamed !== found.messages) throw new Error(`${streamed} messages in a row, ${found.messages} by index`);
  console.log(JSON.stringify(found));
}

main(process.argv[2]).catch((error) => {
  console.error(error.message);
  process.exit(1);
});
