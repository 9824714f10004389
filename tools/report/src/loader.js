// Unpacks the page's own script, which is stored deflated. Kept in words that old browsers know.
(function () {
  function fail(text) {
    document.getElementById('loading').textContent = text;
    document.documentElement.setAttribute('data-report', 'failed');
  }
  if (!('DecompressionStream' in window)) {
    fail('This browser is too old for this page: ' +
      'it needs Chrome or Edge 90, Firefox 113, Safari 16.4 or newer.');
    return;
  }
  try {
    var element = document.getElementById('bundle');
    var binary = atob(element.textContent);
    var bytes = new Uint8Array(binary.length);
    for (var i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
    var stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
    new Response(stream).text().then(function (code) {
      var script = document.createElement('script');
      script.textContent = code;
      element.remove();
      document.body.appendChild(script);
    }).catch(function () { fail('This page is damaged: its script cannot be unpacked.'); });
  } catch (error) {
    fail('This page is damaged: its script cannot be unpacked.');
  }
})();
