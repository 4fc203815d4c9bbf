// SPDX-License-Identifier: Apache-2.0
// Draws the frame: the scene into an image of floats with its depth, then the posts over it.
"use strict";

/// Clip space of isoshade to that of WebGL: depth is 0 to w in one and -w to w in the other, unless WebGL can be told. The
/// depths in images are those of isoshade in both cases, but more precise far away if it can.
function chooseClipSpace(gl) {
  const control = gl.getExtension("EXT_clip_control");
  control?.clipControlEXT(control.LOWER_LEFT_EXT, control.ZERO_TO_ONE_EXT);
  return control ? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] : [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, -1, 1];
}

/// What names of a forward pair begin with that are not the document's (compiler/interface/forward.def).
const prefix = "isoshade_";

/// The size of a post's image. The fraction is a float, the product exact.
function postSize({ size }, width, height) {
  return [Math.ceil(width * size), Math.ceil(height * size)];
}

/// The number at the end of a sampler's name: "image2".
const numberIn = (name) => Number(name.match(/\d+$/)[0]);

class Frame {
  constructor(gl, data, values) {
    Object.assign(this, { gl, data, values });
    this.webglFromClip = chooseClipSpace(gl);
    this.hasFloats = gl.getExtension("EXT_color_buffer_float") !== null;
    this.colorFormat = this.hasFloats ? gl.RGBA32F : gl.RGBA8;
    this.programs = data.programs.map((program) => new Program(gl, program));
    this.textures = new Map();
    this.textureOfRecord = new Map(data.textures.map(({ record }, number) => [record, number]));
    this.noImage = makeTexture(gl, gl.RGBA32F, 1, 1);
    this.targets = new Map();  // by the name of what draws into them
    this.makeMeshes();
    this.slices = new Slices(gl);
    this.places = data.draws.map((draw) => this.reservePlaces(this.programs[draw.program]));
    this.postPlaces = data.posts.map((post) => this.reservePlaces(this.programs[post.program]));
  }

  /// Where the blocks of one draw lie in the buffer.
  reservePlaces(program) {
    return program.blocks.map(({ size }) => this.slices.reserve(size));
  }

  makeMeshes() {
    const { gl, data } = this;
    const vertices = gl.createBuffer(), indices = gl.createBuffer();
    gl.bindVertexArray(null);
    gl.bindBuffer(gl.ARRAY_BUFFER, vertices);
    gl.bufferData(gl.ARRAY_BUFFER, data.vertices, gl.STATIC_DRAW);
    this.arrays = this.programs.map((program) => {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
      for (const { name, location } of program.attributes) {
        const part = own(data.layouts.vertex, name.slice(`${prefix}in_`.length));
        if (!part) throw new Error(`the page has no vertex attribute ${name}`);
        gl.enableVertexAttribArray(location);
        gl.vertexAttribPointer(location, part[1], gl.FLOAT, false, 4 * data.layouts.vertex_words, 4 * part[0]);
      }
      return array;
    });
    if (this.arrays.length > 0) gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, data.indices, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
  }

  /// A texture with its mip levels and, for the target TEXTURE_2D_ARRAY, its layers.
  makeImage({ layers }, target) {
    const { gl } = this;
    const [{ width, height }] = layers[0];
    const isArray = target === gl.TEXTURE_2D_ARRAY;
    const texture = makeTexture(gl, gl.RGBA32F, width, height, layers[0].length, isArray ? layers.length : undefined);
    layers.slice(0, isArray ? undefined : 1).forEach((levels, layer) => levels.forEach((level, number) => {
      const texels = this.texelsOf(level);
      if (isArray)
        gl.texSubImage3D(target, number, 0, 0, layer, level.width, level.height, 1, gl.RGBA, gl.FLOAT, texels);
      else gl.texSubImage2D(target, number, 0, 0, level.width, level.height, gl.RGBA, gl.FLOAT, texels);
    }));
    return texture;
  }
  /// Bytes become the floats that isoshade reads, by its own tables.
  texelsOf({ first, width, height, table }) {
    const { data } = this;
    if (table < 0) return data.texels.subarray(first, first + 4 * width * height);
    const bytes = data.texel_bytes.subarray(4 * first, 4 * (first + width * height));
    return Float32Array.from(bytes, (byte, i) => data.texels[(i % 4 === 3 ? 0 : table) + byte]);
  }
  /// The texture of a record, or undefined, made when it is first read as `target`.
  textureOf(record, target) {
    const number = this.textureOfRecord.get(record);
    if (number === undefined) return undefined;
    const key = `${number} ${target}`;
    if (!this.textures.has(key)) this.textures.set(key, this.makeImage(this.data.textures[number], target));
    return this.textures.get(key);
  }

  target(name, width, height, hasDepth) {
    const old = this.targets.get(name);
    if (old && old.width === width && old.height === height) return old;
    if (old) old.release();
    const made = new Target(this.gl, width, height, this.colorFormat, hasDepth);
    this.targets.set(name, made);
    return made;
  }

  /// Fills the blocks of a draw or post with values by the names of their members. `state`: the values of each block.
  fillBlocks(program, places, state) {
    program.blocks.forEach((block, b) => {
      const values = state[block.name.slice(prefix.length)];
      fillBlock(this.slices.view, places[b], block, (name) => values.get(name.slice(name.indexOf(".") + 1)));
    });
  }

  viewValues(view, time) {
    return new Map(Object.entries({
      view_from_world: affine(view.view), world_from_view: affine(view.inverse_view),
      clip_from_view: multiply(this.webglFromClip, view.projection), eye: view.eye, pixel_size: view.pixel_size, time: [time],
    }));
  }
  screenValues(view, time, size) {
    const vectors = ["view_ray", "ray_origin"].flatMap((name) =>
      ["", "_right", "_down"].map((end, i) => [name + end, view[name].slice(3 * i, 3 * i + 3)]));
    return new Map([...Object.entries({ ...view, size, time: [time] }), ...vectors]);
  }
  objectValues(draw, record) {
    const object = unpack(this.data.records, draw.object, this.data.layouts.object);
    return new Map(Object.entries({
      world_from_object: affine(object.model), object_from_world: affine(object.inverse), pass_index: object.pass_index,
      pass_count: draw.repeat === null ? object.pass_count : [Math.floor(record[draw.repeat])],
    }));
  }

  /// The block has room for more lights than the scene has.
  lightValues() {
    const { lights, layouts } = this.data;
    const values = new Map([["count", [Math.min(lights.length, layouts.most_lights)]]]);
    for (let i = 0; i < layouts.most_lights; ++i)
      for (const [name, part] of Object.entries(unpack(lights[i] ?? [], 0, layouts.light)))
        values.set(`lights[${i}].${name}`, part);
    return values;
  }

  /// The members of a block of parameters, from the words of a record.
  parameterValues({ parameters }, record) {
    const values = new Map();
    parameters.forEach((name, word) => {
      let end = word + 1;
      while (end < parameters.length && parameters[end] === "") ++end;
      if (name !== "") values.set(name, record.slice(word, end));
    });
    return values;
  }

  /// Binds to each sampler of a program what `textureOf` gives for its name.
  bindSamplers(program, textureOf) {
    const { gl } = this;
    program.samplers.forEach(({ name, type }, unit) => {
      const target = type === gl.SAMPLER_2D ? gl.TEXTURE_2D : gl.TEXTURE_2D_ARRAY;
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(target, textureOf(name.slice(prefix.length), target) ?? (type === gl.SAMPLER_2D ? this.noImage : null));
    });
  }

  /// Which faces of a draw are left out.
  cullOf(draw, record) {
    return draw.double_sided !== null && record[draw.double_sided] !== 0 ? "none" : draw.cull;
  }

  /// The device's blending of a draw: close to isoshade's. "multiply" relies on the forward shader, which multiplies the
  /// color by its alpha.
  blend(draw, record) {
    const { gl } = this;
    const opaque = draw.blend === "none" || this.isOff(draw.blended, record);
    gl.depthMask(opaque || draw.depth_write === "on");
    if (opaque) return gl.disable(gl.BLEND);
    gl.enable(gl.BLEND);
    const through = gl.ONE_MINUS_SRC_ALPHA;
    gl.blendFuncSeparate(...{
      over: [gl.SRC_ALPHA, through, gl.ONE, through],
      add: [gl.SRC_ALPHA, gl.ONE, gl.ZERO, gl.ONE],
      multiply: [gl.DST_COLOR, through, gl.ZERO, gl.ONE],
      premultiplied: [gl.ONE, through, gl.ONE, through],
    }[draw.blend]);
  }

  /// Whether a draw is a repetition of its pass beyond those that a parameter asks for.
  isBeyond(draw, record) {
    const [index] = unpack(this.data.records, draw.object, this.data.layouts.object).pass_index;
    return draw.repeat !== null && index >= Math.floor(record[draw.repeat]);
  }

  /// Whether a pass or post is switched off by a parameter.
  isOff(enabled, record) {
    return enabled !== null && record[enabled] === 0;
  }

  /// Fills the blocks of all draws and posts. `view`: the parts of the view's record.
  fill(view, time, width, height) {
    const { data, programs, slices } = this;
    const Lights = this.lightValues();
    const View = this.viewValues(view, time);
    this.drawRecords = data.draws.map((draw, d) => {
      const first = draw.object + data.layouts.object_words;
      const record = data.records.slice(first, first + draw.words);
      this.values.apply(draw.owner, record);
      this.fillBlocks(programs[draw.program], this.places[d], {
        View, Lights, Object: this.objectValues(draw, record),
        Parameters: this.parameterValues(data.programs[draw.program], record),
      });
      return record;
    });
    this.postRecords = data.posts.map((post, p) => {
      const record = Float32Array.from(post.record);
      this.values.apply(post.owner, record);
      this.fillBlocks(programs[post.program], this.postPlaces[p], {
        Screen: this.screenValues(view, time, postSize(post, width, height)),
        Parameters: this.parameterValues(data.programs[post.program], record),
      });
      return record;
    });
    slices.upload();
  }

  use(number, places) {
    const { gl } = this;
    const program = this.programs[number];
    gl.useProgram(program.program);
    gl.bindVertexArray(this.arrays[number]);
    program.blocks.forEach((block, b) => this.slices.bind(block.index, places[b], block.size));
    return program;
  }

  /// The finished image: colours as floats where the browser has them.
  draw(view, time, width, height) {
    const { gl, data } = this;
    this.fill(view, time, width, height);
    const scene = this.target("scene", width, height, true);
    scene.use();
    gl.clearBufferfv(gl.COLOR, 0, data.background);
    gl.depthMask(true);
    gl.clearBufferfv(gl.DEPTH, 0, [0]);
    gl.enable(gl.DEPTH_TEST);
    data.draws.forEach((draw, d) => {
      const record = this.drawRecords[d];
      if (this.isOff(draw.enabled, record) || this.isBeyond(draw, record)) return;
      const program = this.use(draw.program, this.places[d]);
      this.bindSamplers(program, (name, target) => this.textureOf(record[draw.images + numberIn(name)], target));
      const cull = this.cullOf(draw, record);
      if (cull === "none") gl.disable(gl.CULL_FACE);
      else gl.enable(gl.CULL_FACE);
      if (cull !== "none") gl.cullFace(cull === "back" ? gl.BACK : gl.FRONT);
      gl.frontFace(draw.mirrored ? gl.CW : gl.CCW);
      gl.depthFunc(draw.depth === "always" ? gl.ALWAYS : gl.GREATER);
      this.blend(draw, record);
      gl.drawElements(gl.TRIANGLES, draw.count, gl.UNSIGNED_INT, 4 * draw.first);
    });
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.BLEND);
    return this.drawPosts(scene, width, height);
  }

  drawPosts(scene, width, height) {
    const { gl, data } = this;
    const images = [scene];
    data.posts.forEach((post, p) => {
      if (this.isOff(post.enabled, this.postRecords[p])) {
        images.push(images[post.over]);
        return;
      }
      const made = this.target(`post ${p}`, ...postSize(post, width, height), false);
      const program = this.use(post.program, this.postPlaces[p]);
      this.bindSamplers(program, (name) => (name === "depth_picture" ? scene.depth
        : images[post.sources[numberIn(name)]]?.color));
      made.use();
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      images.push(made);
    });
    return images[images.length - 1];
  }
}
