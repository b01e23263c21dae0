// SPDX-License-Identifier: Apache-2.0
document.documentElement.classList.add('js');
document.addEventListener('input', function (event) {
  if (event.target.matches('.slide input')) {
    event.target.closest('.triple').style.setProperty('--at', event.target.value + '%');
  }
});
// Above a table that is wider than the page: that it can be moved.
function showHints() {
  document.querySelectorAll('.wide').forEach(function (box) {
    var before = box.previousElementSibling, hint = before && before.className === 'hint' ? before : null;
    var wider = box.scrollWidth > box.clientWidth + 1;
    if (wider && !hint) {
      hint = document.createElement('p');
      hint.className = 'hint';
      hint.textContent = 'The table goes on to the right: swipe or scroll \u2192';
      box.parentNode.insertBefore(hint, box);
    }
    if (!wider && hint) hint.remove();
    box.tabIndex = wider ? 0 : -1;
  });
}
window.addEventListener('load', showHints);
window.addEventListener('resize', showHints);
