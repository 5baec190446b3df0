// The blocks that apps/html/packed.cc makes: length of a JSON text, the text, then numbers; deflated, in base64.
export async function unpack(id) {
  const digits = atob(document.getElementById(id).textContent), packed = new Uint8Array(digits.length);
  for (let k = 0; k < digits.length; ++k) packed[k] = digits.charCodeAt(k);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = await new Response(stream).arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  return {json: JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))), bytes: bytes.slice(4 + length)};
}

// A row, with `q(k)`, the nq numbers of frame k, and `poses`: frames × bodies × (position, quaternion w x y z).
export async function unpackRow(index) {
  const {json, bytes} = await unpack(`row${index}`);
  const {nq, frames} = json, q = new Float64Array(bytes, 0, nq * frames.length);
  return {...json, q: (k) => [...q.subarray(nq * k, nq * (k + 1))], poses: new Float32Array(bytes, q.byteLength)};
}
