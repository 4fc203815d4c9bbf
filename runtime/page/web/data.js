// SPDX-License-Identifier: Apache-2.0
// What the page was made from: numbers, texts and arrays, all of them as JSON. No text of a document becomes code or
// markup: names and docs are only ever shown by textContent.
"use strict";

/// The bytes of a base64 text, as an array of `Type`.
function decode(text, Type) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return new Type(bytes.buffer);
}

/// The data of the page with its arrays decoded.
function readData() {
  const data = JSON.parse(document.getElementById("data").textContent);
  data.vertices = decode(data.vertices, Float32Array);
  data.indices = decode(data.indices, Uint32Array);
  data.records = decode(data.records, Float32Array);
  data.texels = decode(data.texels, Float32Array);
  data.texel_bytes = decode(data.texel_bytes, Uint8Array);
  data.reference.rgba = decode(data.reference.rgba, Float32Array);
  return data;
}

/// The words of a record by the names of its parts. `layout`: the first word and the number of words of each.
function unpack(words, first, layout) {
  const parts = {};
  for (const [name, [at, count]] of Object.entries(layout)) parts[name] = words.slice(first + at, first + at + count);
  return parts;
}

/// What an object has itself under a name; names of documents may be those of what every object inherits.
function own(object, name) {
  return Object.hasOwn(object, name) ? object[name] : undefined;
}

/// The shortest decimal that is this float32.
function floatText(value) {
  for (let digits = 1; digits < 9; ++digits) {
    const text = String(Number(value.toPrecision(digits)));
    if (Math.fround(Number(text)) === Math.fround(value)) return text;
  }
  return String(Number(value.toPrecision(9)));
}

/// The transfer function of sRGB, and its inverse.
function srgbEncode(linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * Math.pow(linear, 1 / 2.4) - 0.055;
}
function srgbDecode(encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : Math.pow((encoded + 0.055) / 1.055, 2.4);
}

/// The values in effect: those of the scene, until the panel changes them. An owner is an object or a post.
class Values {
  constructor(owners) {
    this.owners = owners;
    this.changed = owners.map(() => new Map());  // of each owner: words by the number of the field
    this.listeners = [];
  }

  /// The words that a control shows: of a field that varies over a grid, those of the first copy.
  get(owner, field) {
    return this.changed[owner].get(field) ?? this.own(owner, field);
  }
  own(owner, field) {
    const { word, words } = this.owners[owner].fields[field];
    return this.owners[owner].values.slice(word, word + words);
  }
  set(owner, field, words) {
    this.changed[owner].set(field, words.map(Math.fround));
    this.notify(owner);
  }
  reset(owner, field) {
    this.changed[owner].delete(field);
    this.notify(owner);
  }
  resetAll() {
    for (const changes of this.changed) changes.clear();
    for (let owner = 0; owner < this.owners.length; ++owner) this.notify(owner);
  }
  notify(owner) {
    for (const listener of this.listeners) listener(owner);
  }

  /// Writes the changes of an owner over a record of its parameters.
  apply(owner, record) {
    for (const [field, words] of this.changed[owner]) record.set(words, this.owners[owner].fields[field].word);
  }

  /// "balls.roughness=0.3", one for each change.
  settings() {
    return this.owners.flatMap(({ name, fields }, owner) => [...this.changed[owner]]
      .sort(([a], [b]) => a - b)
      .map(([field, words]) => `${name}.${fields[field].name}=${valueText(fields[field], words)}`));
  }
}

/// A value as --set reads it.
function valueText(field, words) {
  if (field.type === "boolean") return words[0] !== 0 ? "true" : "false";
  const named = field.names?.[words[0]];
  if (named !== undefined && !["true", "false", "null"].includes(named)) return named;
  return words.map(floatText).join(",");
}
