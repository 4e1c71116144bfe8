! Grids that are assigned, and procedures that fail and are asked for their status. It is run with the address sanitizer.
program grids
  use teracell
  implicit none

  type :: model
    type(tc_grid) :: grid
    integer :: step = 0
  end type

  character(len=1000) :: path
  integer(int64) :: n(3)
  integer :: status

  call get_command_argument(1, path)
  call assign_grids()
  call fail_softly()
  print '(a)', 'done'

contains

  subroutine expect(good, what)
    logical, intent(in) :: good
    character(len=*), intent(in) :: what
    if (good) return
    print '(2a)', 'wrong: ', what
    error stop 1
  end subroutine

  subroutine assign_grids()
    type(tc_grid) :: a, b, several(3)
    type(model) :: one, two
    integer(int8) :: cells(4, 4, 4), again(4, 4, 4)
    integer :: i
    call a%open(trim(path))
    n = a%shape()
    call a%read(n / 2, cells)
    b = a
    a = a
    call a%close()
    call b%read(n / 2, again)
    call expect(all(cells == again), 'a copy reads after its original was closed')
    n = a%shape(status=status)
    call expect(status == tc_usage, 'a closed grid is an error')
    do i = 1, 1000  ! and many files would stay open if the one before were not closed
      call several(1)%open(trim(path))
      several(2) = several(1)
    end do
    several(3) = b
    several(1:2) = several(2:3)
    one%grid = b
    call b%close()
    two = one
    call one%grid%close()
    n = two%grid%shape()
    call two%grid%read(n / 2, again)
    call expect(all(cells == again), 'a copy in a structure reads')
    call several(2)%read(n / 2, again)
    call expect(all(cells == again), 'a copy in an array reads')
  end subroutine  ! closes the rest

  subroutine fail_softly()
    type(tc_grid) :: grid
    integer :: id
    real(real64), allocatable :: along(:)
    character(len=:), allocatable :: name
    call grid%open('none.tcell', status)
    call expect(status == tc_io .and. index(tc_error_text(), 'none.tcell') > 0, 'open')
    call grid%open(trim(path), status)
    call expect(status == tc_ok, 'open what is there')
    n = grid%shape(99, status)
    call expect(status == tc_usage .and. all(n == 0), 'shape of a level')
    n = grid%shape(status=status)
    call expect(status == tc_ok .and. all(n > 0), 'shape')
    along = grid%planes(0, status=status)
    call expect(size(along) == 0 .and. status == tc_usage, 'planes along 0')
    along = grid%planes(4, status=status)
    call expect(size(along) == 0 .and. status == tc_usage, 'planes along 4')
    along = grid%planes(1, 99, status)
    call expect(size(along) == 0 .and. status == tc_usage, 'planes of a level')
    along = grid%planes(3, status=status)
    call expect(size(along) == n(3) + 1 .and. status == tc_ok, 'planes along 3')
    along = grid%samples(-1, status=status)
    call expect(size(along) == 0 .and. status == tc_usage, 'samples along -1')
    along = grid%samples(2, status=status)
    call expect(size(along) == n(2) .and. status == tc_ok, 'samples along 2')
    name = grid%material(-1, status)
    call expect(name == '' .and. status == tc_usage, 'material -1')
    name = grid%material(grid%materials(), status)
    call expect(name == '' .and. status == tc_usage, 'a material too many')
    name = grid%material(0, status)
    call expect(name == 'air' .and. status == tc_ok, 'material 0')
    id = grid%uniform(n, n + 1, status=status)
    call expect(id == -1 .and. status == tc_usage, 'uniform outside')
    call expect(len(grid%hash()) == 32, 'hash')
  end subroutine
end program
