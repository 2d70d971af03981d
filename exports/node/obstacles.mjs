// Runs an exported obstacle model on one picture.
//
//   node obstacles.mjs MODEL.onnx PICTURE.ppm [UP_X UP_Y UP_Z] [--maps FILE.json]
//
// PICTURE is a binary PPM (P6) of the camera's size: `convert picture.jpg picture.ppm`. UP is the world's up
// as a unit vector in the camera's optical frame (x right, y down, z forward); 0 -1 0 is a level camera, and
// without it the horizon is not known.

import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import * as ort from "onnxruntime-node";

const SEAL = /horizon-dl obstacle model, format (\d+), bytes (\d{10}), sha256 ([0-9a-f]{64})/;

/** The bytes of a model file; throws if it is no model, cut off, or altered. */
function readModel(path) {
  const content = readFileSync(path);
  const seal = SEAL.exec(content.subarray(0, 4096).toString("latin1"));
  if (!seal) throw new Error(`${path}: is no obstacle model of horizon-dl`);
  if (Number(seal[2]) !== content.length) throw new Error(`${path}: is cut off`);
  const unsigned = Buffer.from(content);
  unsigned.fill("0", seal.index + seal[0].length - 64, seal.index + seal[0].length);
  const digest = createHash("sha256").update(unsigned).digest("hex");
  if (digest !== seal[3]) throw new Error(`${path}: was altered or is damaged`);
  return content;
}

/** Width, height and RGB bytes of a binary PPM. */
function readPpm(path) {
  const content = readFileSync(path);
  const head = /^P6\s+(\d+)\s+(\d+)\s+255\s/.exec(content.subarray(0, 64).toString("latin1"));
  if (!head) throw new Error(`${path}: is no binary PPM with 8 bits a channel`);
  const [width, height] = [Number(head[1]), Number(head[2])];
  const pixels = new Uint8Array(content.subarray(head[0].length, head[0].length + 3 * width * height));
  if (pixels.length !== 3 * width * height) throw new Error(`${path}: is cut off`);
  return { width, height, pixels };
}

function mean(values) {
  let sum = 0;
  for (const value of values) sum += value;
  return sum / values.length;
}

const options = process.argv.slice(2);
const mapsAt = options.indexOf("--maps");
const mapsFile = mapsAt < 0 ? null : options.splice(mapsAt, 2)[1];
const [modelPath, picturePath, ...up] = options;
if (!picturePath || (up.length !== 0 && up.length !== 3)) {
  console.error("usage: node obstacles.mjs MODEL.onnx PICTURE.ppm [UP_X UP_Y UP_Z] [--maps FILE.json]");
  process.exit(2);
}

try {
  const session = await ort.InferenceSession.create(readModel(modelPath), {
    intraOpNumThreads: 1,
    extra: { session: { intra_op: { allow_spinning: "0" } } },
  });
  const { width, height, pixels } = readPpm(picturePath);
  const upCam = up.length ? up.map(Number) : [NaN, NaN, NaN];
  const outputs = await session.run({
    image: new ort.Tensor("uint8", pixels, [1, height, width, 3]),
    up_cam: new ort.Tensor("float32", Float32Array.from(upCam), [3]),
  });
  console.log(`obstacle pixels ${(100 * mean(outputs.obstacles.data)).toFixed(1)} %`);
  console.log(`mean entropy ${mean(outputs.entropy.data).toFixed(4)} bits`);
  if (mapsFile) {
    const maps = Object.entries(outputs).map(([name, map]) => [name, { dims: map.dims, data: Array.from(map.data) }]);
    writeFileSync(mapsFile, JSON.stringify(Object.fromEntries(maps)));
  }
} catch (error) {
  console.error(`obstacles.mjs: ${error.message.split("\n")[0]}`);
  process.exit(1);
}
