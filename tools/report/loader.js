// Unpacks the program and the data of the page, which are deflated. In words that old browsers know.
function fail(text) {
  document.getElementById('loading').hidden = true;
  document.getElementById('problems').hidden = false;
  document.getElementById('problems').textContent += text + ' ';
  document.documentElement.setAttribute('data-report', 'failed');
}

// Of an element: a promise of a response that holds what is packed in it.
function unpacked(id) {
  var binary = atob(document.getElementById(id).textContent);
  var bytes = new Uint8Array(binary.length);
  for (var i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return new Response(
    new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')));
}

if (!('DecompressionStream' in window)) {
  fail('This browser is too old for this page: ' +
    'it needs Chrome or Edge 90, Firefox 113, Safari 16.4 or newer.');
} else {
  unpacked('program').text().then(function (text) {
    var script = document.createElement('script');
    script.textContent = text;
    document.body.appendChild(script);
  }).catch(function () { fail('This page is damaged: its program cannot be unpacked.'); });
}
